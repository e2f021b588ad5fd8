#include "hwparts/drive/drive.h"

#include <algorithm>
#include <cmath>

#include "hwparts/drive/encoder.h"
#include "hwparts/drive/motor.h"
#include "hwparts/drive/state_word.h"
#include "hwparts/drive/supervision.h"

namespace visum::drive {
namespace {

constexpr double kStillSpeed = 5e-3;  // share of the maximum speed; an axis under current control that is
                                      // slower counts as standing

// Cuts the window to the maximum current that the tuning allows.
CurrentWindow narrowed(CurrentWindow window, double most) {
  if (window.upper > most) window.upper = most, window.upper_by_voltage = false;
  if (window.lower < -most) window.lower = -most, window.lower_by_voltage = false;
  return window;
}

}  // namespace

Drive::Drive(const DriveData& data, double position, bool homed, double tick_s, const Load& load)
    : data_(data),
      tick_s_(tick_s),
      by_mean_speed_(load.moves_by_mean_speed),
      places_(places_of(data, load, tick_s)),
      period_s_(data.loop_period(tick_s)),
      loop_ticks_(static_cast<std::uint32_t>(std::llround(period_s_ / tick_s))),
      initial_(initial_state(data, position, homed)),
      state_(initial_) {}

void Drive::act(const Command& command, std::span<const hwparts::JointSample> joints,
                std::span<hwparts::JointDrive> drives) {
  state_.winding = std::max(state_.winding, broken_.least_winding);
  const Trip before = figures_of(state_);
  supervise(data_, state_);
  move_brake(data_.brake, state_, tick_s_);
  state_.commanded = command.target;
  const bool loop_runs = state_.loop.age == 0;
  state_.loop.age = (state_.loop.age + 1) % loop_ticks_;
  if (loop_runs || !ready(state_)) move_setpoint(command);
  note_trip(before);
  plan_ = plan_rotor(data_, state_, drive_motor(loop_runs), brake_holds(), by_mean_speed_, tick_s_);
  const double most_effort = std::min(data_.gear.breaking_effort, broken_.slip_effort);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    drives[i] = couple(data_, plan_, state_, places_, most_effort, joints.size(), joints[i], tick_s_);
  }
  acted_ = true;
}

void Drive::note_trip(const Trip& before) {
  const std::uint32_t bits = new_faults(state_.latched, known_);
  // A fault that comes on top of others joins them. The lag of the first one is gone from the state by now.
  const std::uint32_t older = has(state_, state_bit::kError) ? trip_.bits & known_ : 0;
  known_ = state_.latched;
  if (bits == 0) return;
  const double lag = (older & state_bit::kTowError) != 0 ? trip_.lag : before.lag;
  trip_ = before;
  trip_.bits = bits | older;
  trip_.lag = lag;
  ++trips_;
}

bool Drive::brake_holds() const {
  if (broken_.brake == BrakeFault::kNone) return state_.brake_closed;
  return broken_.brake == BrakeFault::kStuckClosed;
}

double Drive::encoder(double noise) const {
  if (broken_.encoder_stuck) return state_.measured_position;
  return quantised(data_, state_.rotor_position + broken_.encoder_offset + noise) + state_.zero_offset;
}

void Drive::publish(std::span<const hwparts::JointSample> joints, double encoder_noise) {
  for (std::size_t i = 0; i < joints.size(); ++i) state_.joint_position[i] = joints[i].position;
  if (!acted_) return;
  acted_ = false;
  move_rotor(data_, plan_, joints, tick_s_, state_);
  slip_gear(data_, joints, broken_.slip_effort, state_);
  watch_gear(data_.gear, state_);
  const double measured = encoder(encoder_noise);
  state_.loop.travel += measured - state_.measured_position;
  state_.measured_position = measured;
  if (state_.loop.age == 0) {  // the loop runs in the next tick
    state_.measured_speed = filtered_speed(data_.loop, state_.measured_speed, state_.loop.travel, period_s_);
    state_.loop.travel = 0.0;
  }
  state_.i2t = advance_i2t(data_.motor, state_.i2t, state_.current, tick_s_);
  state_.winding = advance_winding(data_.motor, state_.winding, state_.current, tick_s_);
}

void Drive::restart() {
  state_ = initial_;
  acted_ = false;
  known_ = state_.latched;
}

void Drive::save(hwparts::StateWriter& to) const {
  drive::save(state_, to);
  if (loop_ticks_ > 1) drive::save(state_.loop, to);
}

void Drive::load(hwparts::StateReader& from) {
  drive::load(state_, from);
  state_.loop = {};
  if (loop_ticks_ > 1) drive::load(state_.loop, from);
  acted_ = false;
  known_ = state_.latched;
}

// Moves the setpoint on by one period of the loop: home, as the bus commanded, to the ports' target, or to a
// stop. While the loop is open it stays at the axis.
void Drive::move_setpoint(const Command& command) {
  auto& setpoint = state_.setpoint;
  if (!ready(state_)) {
    // A command that waits for the brake shows motion, so that no client takes it for finished.
    const bool begins = state_.loop_closed && (state_.homing || state_.motion.kind != MotionKind::kNone);
    setpoint = {state_.measured_position, 0.0, begins ? RampPhase::kAccelerating : RampPhase::kEnd};
    return;
  }
  if (state_.homing && command.enabled) return home_on(command);
  const bool stopped = has(state_, state_bit::kError | state_bit::kHalted) || !command.enabled;
  if (stopped) state_.motion = {};
  const bool free = !stopped && has(state_, state_bit::kHomeOk);  // may follow the ports
  if (free && state_.holding) state_.holding = command.target == state_.hold_target;
  if (free && !state_.holding) release_to_ports(state_);
  if (state_.motion.kind != MotionKind::kNone) {
    const auto next = follow_bus();
    if (!has(state_, state_bit::kError)) {
      setpoint = next;
      return;
    }
  }
  if (free && !state_.by_bus && !state_.holding) {
    const auto next = follow_ports(command);
    if (!has(state_, state_bit::kError)) {
      setpoint = next;
      return;
    }
  }
  setpoint = ramp_stop(setpoint, data_.limits.stop_deceleration, period_s_);
}

Setpoint Drive::follow_ports(const Command& command) {
  const MotionLimits limits{std::min(command.maximum_speed, state_.tuning.maximum_speed),
                            state_.tuning.maximum_acceleration};
  if (data_.speed_controlled) return keep_speed(command.target, limits);
  const double target = reachable_target(data_, state_, command.target);
  return ramp_to(state_.setpoint, target, limits.speed, limits.acceleration, period_s_);
}

// One period of homing: goes to the reference switch, where the encoder's zero becomes known; then, if asked
// for, to 0. A speed-controlled drive has no such place: it stops.
void Drive::home_on(const Command& command) {
  auto& setpoint = state_.setpoint;
  const double target = state_.moves_to_zero ? 0.0 : data_.home.position + state_.zero_offset;
  const double acceleration = state_.tuning.maximum_acceleration;
  setpoint = data_.speed_controlled
                 ? ramp_stop(setpoint, acceleration, period_s_)
                 : ramp_to(setpoint, target, state_.tuning.home_speed, acceleration, period_s_);
  if (setpoint.phase != RampPhase::kEnd) return;
  if (!state_.moves_to_zero) set_zero(state_);
  state_.referenced = true;
  state_.moves_to_zero = state_.zero_after_home && !state_.moves_to_zero;
  if (state_.moves_to_zero) return;
  state_.homing = false;
  state_.latched |= state_bit::kHomeOk;
  drive::hold(state_, command.target);
}

// One period towards a speed, or at it, as far as the soft limits allow.
Setpoint Drive::keep_speed(double speed, const MotionLimits& limits) {
  constexpr double kFar = 1e6;  // [u] ahead: further than any braking distance
  const auto& from = state_.setpoint;
  if (speed == 0.0) return ramp_stop(from, limits.acceleration, period_s_);
  const double target = reachable_target(data_, state_, from.position + (speed > 0.0 ? kFar : -kFar));
  return ramp_to(from, target, std::min(std::abs(speed), limits.speed), limits.acceleration, period_s_);
}

// One period of the motion that the bus commanded.
Setpoint Drive::follow_bus() {
  auto& motion = state_.motion;
  const auto& from = state_.setpoint;
  const auto limits = motion_limits();
  const double speed = std::min(motion.speed, limits.speed);
  const double acceleration = std::min(motion.acceleration, limits.acceleration);
  switch (motion.kind) {
    case MotionKind::kRamp:
      return ramp_to(from, reachable_target(data_, state_, motion.target), speed, acceleration, period_s_);
    case MotionKind::kVelocity:
      return keep_speed(motion.target, {limits.speed, acceleration});
    case MotionKind::kStep: {
      const double target = reachable_target(data_, state_, motion.target);
      return stopping_inside(step_on(motion, from, target, limits, period_s_), target, limits);
    }
    case MotionKind::kCosine: {
      // An end beyond a soft limit is gone to on a ramp, which trips there.
      const double target = reachable_target(data_, state_, motion.target);
      if (target != motion.target) return ramp_to(from, target, limits.speed, acceleration, period_s_);
      return turn(motion, from, {limits.speed, acceleration}, period_s_);
    }
    case MotionKind::kCurrent: {
      watch_way(state_, motion.target);
      if (has(state_, state_bit::kError)) return from;
      const bool moves = std::abs(state_.measured_speed) > kStillSpeed * limits.speed;
      return follow_axis(motion, state_.measured_position, state_.measured_speed, moves, period_s_);
    }
    case MotionKind::kNone:
      break;
  }
  return from;
}

// `next`, unless the axis could no longer stop inside the soft limits from there: a stream of steps may end
// at speed, and near a limit it would trip it before it stands. Then one period of braking.
Setpoint Drive::stopping_inside(const Setpoint& next, double target, const MotionLimits& limits) const {
  const auto& tuning = state_.tuning;
  if (!data_.limits.limited || !state_.referenced || state_.soft_side != 0) return next;
  const double lowest = std::min(target, tuning.soft_minimum + data_.limits.tolerance);
  const double highest = std::max(target, tuning.soft_maximum - data_.limits.tolerance);
  const double stops_at = next.position + 0.5 * next.speed * std::abs(next.speed) / limits.acceleration;
  const bool inside = next.speed > 0.0 ? stops_at <= highest : stops_at >= lowest || next.speed == 0.0;
  if (inside) return next;
  return ramp_to(state_.setpoint, std::clamp(stops_at, lowest, highest), limits.speed, limits.acceleration,
                 period_s_);
}

CurrentCommand Drive::command_current(const CurrentWindow& window, bool loop_runs) const {
  if (state_.motion.kind == MotionKind::kCurrent)
    return limit_current(state_.motion.target, state_.integral_current, window);
  if (loop_runs) return control_current(data_, state_, window, period_s_);
  return limit_current(state_.loop.wanted_current, state_.integral_current, window);
}

MotorEffort Drive::drive_motor(bool loop_runs) {
  auto& wanted = state_.loop.wanted_current;
  if (!ready(state_)) {
    state_.current = state_.integral_current = wanted = 0.0;
    return {};
  }
  const auto window = narrowed(current_window(data_, state_.tuning.supply_voltage, state_.rotor_speed),
                               state_.tuning.maximum_current);
  const auto command = command_current(window, loop_runs);
  wanted = command.wanted;
  state_.current = command.current;
  state_.integral_current = command.integral;
  if (command.limited) state_.latched |= state_bit::kCurLimit;
  const double constant = data_.effort_per_amp() * broken_.torque_share;  // [F]/A
  const double slope = constant * data_.effort_per_amp() / data_.motor.resistance;
  return {constant * command.current, command.by_voltage ? slope : 0.0};
}

}  // namespace visum::drive

#include "hwparts/drive/supervision.h"

#include <algorithm>
#include <cmath>

#include "hwparts/drive/motor.h"
#include "hwparts/drive/state_word.h"

namespace visum::drive {
namespace {

constexpr double kCooledK = 10.0;  // a power stage that tripped must cool this far below its limit

// ---- stopping ----

// Latches a fault and ends homing and bus motions.
void trip(DriveState& state, std::uint32_t bits) {
  state.latched |= state_bit::kError | bits;
  state.homing = false;
  state.motion = {};
}

// Latches a fault that switches the power stage off. A new one needs a new power cycle.
void trip_power_stage(DriveState& state, std::uint32_t bit) {
  if (!has(state, bit)) state.power_cycled = false;
  trip(state, state_bit::kPowerFault | bit);
  open_loop(state);
}

// Puts the setpoint where the axis is, with its speed.
void rebase(const LimitData& limits, DriveState& state) {
  state.setpoint.position = state.measured_position;
  state.setpoint.speed = std::clamp(state.measured_speed, -limits.maximum_speed, limits.maximum_speed);
}

// ---- watching ----

// -1 below, +1 above, 0 inside.
std::int8_t side_of(double position, double minimum, double maximum) {
  if (position < minimum) return -1;
  return position > maximum ? 1 : 0;
}

// Trips once when a limit is crossed. Back inside, the bit goes unless the fault is still latched. True: it
// was crossed now.
bool watch_limit(DriveState& state, std::int8_t now, std::int8_t& known, std::uint32_t bit) {
  const bool crossed = now != 0 && now != known;
  known = now;
  if (crossed) trip(state, bit);
  if (now == 0 && !has(state, state_bit::kError)) state.latched &= ~bit;
  return crossed;
}

void watch_soft_limits(const DriveData& data, DriveState& state) {
  const double minimum = state.tuning.soft_minimum - data.limits.tolerance;
  const double maximum = state.tuning.soft_maximum + data.limits.tolerance;
  if (!state.referenced) return;
  watch_limit(state, side_of(state.measured_position, minimum, maximum), state.soft_side,
              state_bit::kBeyondSoft);
}

void watch_hard_limits(const DriveData& data, DriveState& state) {
  const auto& limits = data.limits;
  const double tolerance = limits.tolerance;
  const auto side =
      side_of(switch_position(state), limits.hard_minimum - tolerance, limits.hard_maximum + tolerance);
  if (watch_limit(state, side, state.hard_side, state_bit::kBeyondHard)) open_loop(state);
}

void watch_following_error(const DriveData& data, DriveState& state) {
  if (!ready(state)) return;
  if (std::abs(state.setpoint.position - state.measured_position) <= state.tuning.following_error) return;
  trip(state, state_bit::kTowError);
  rebase(data.limits, state);
}

void watch_supply(const DriveData& data, DriveState& state) {
  if (state.tuning.supply_voltage >= data.supply.minimum_voltage) return;
  trip_power_stage(state, state_bit::kPowVoltErr);
  state.power_cycled = true;
}

void watch_heat(const DriveData& data, DriveState& state) {
  // At the budget itself the limit current has flowed for exactly as long as it may: no fault yet.
  if (state.i2t > i2t_budget(data.motor)) trip_power_stage(state, state_bit::kIntegralErr);
  if (state.winding > data.motor.maximum_winding) trip_power_stage(state, state_bit::kFetTemp);
}

// ---- Reset ----

// The bits that Reset may clear, since their cause is gone.
std::uint32_t curable(const DriveData& data, const DriveState& state) {
  std::uint32_t bits =
      state_bit::kHalted | state_bit::kTowError | state_bit::kCommError | state_bit::kCurLimit;
  if (state.soft_side == 0) bits |= state_bit::kBeyondSoft;
  if (state.hard_side == 0) bits |= state_bit::kBeyondHard;
  if (state.tuning.supply_voltage >= data.supply.minimum_voltage) bits |= state_bit::kPowVoltErr;
  if (!state.power_cycled) return bits;
  if (i2t_rest(data.motor, state.i2t) == 0.0) bits |= state_bit::kIntegralErr;
  if (state.winding <= data.motor.maximum_winding - kCooledK) bits |= state_bit::kFetTemp;
  return bits;
}

// Closes an open loop where the axis stands. A loop that stayed closed keeps its setpoint: a gripper goes on
// gripping, and an axis goes on stopping on its ramp.
void close_loop(const DriveData& data, DriveState& state) {
  if (state.loop_closed) return;
  rebase(data.limits, state);
  state.setpoint.speed = 0.0;
  state.loop_closed = true;
  state.brake_time = 0.0;
}

// Moves the zero of the module's positions. The axis stays where it is.
void shift_zero(DriveState& state, double change) {
  if (change == 0.0) return;
  state.zero_offset += change;
  state.measured_position += change;
  state.setpoint.position += change;
  hold(state, state.commanded);  // the commanded number meant another place
}

}  // namespace

double switch_position(const DriveState& state) {
  return state.measured_position - state.zero_offset;
}

void supervise(const DriveData& data, DriveState& state) {
  watch_supply(data, state);
  watch_heat(data, state);
  if (data.limits.limited) {
    watch_soft_limits(data, state);
    watch_hard_limits(data, state);
  }
  watch_following_error(data, state);
}

void watch_way(DriveState& state, double way) {
  if (state.soft_side * way > 0.0) trip(state, state_bit::kBeyondSoft);
  if (state.hard_side * way <= 0.0) return;
  trip(state, state_bit::kBeyondHard);
  open_loop(state);
}

double reachable_target(const DriveData& data, DriveState& state, double target) {
  if (!data.limits.limited) return target;
  watch_way(state, target - state.setpoint.position);
  if (!state.referenced) return target;
  const double reachable = std::clamp(target, state.tuning.soft_minimum, state.tuning.soft_maximum);
  const bool stands_at_limit = state.setpoint.position == reachable && state.setpoint.speed == 0.0;
  if (reachable != target && stands_at_limit) trip(state, state_bit::kBeyondSoft);
  return reachable;
}

void move_brake(const BrakeData& brake, DriveState& state, double tick_s) {
  if (!brake.present || state.brake_closed == !state.loop_closed) return;
  state.brake_time += tick_s;
  const double delay = state.loop_closed ? brake.release_time : state.tuning.brake_engage_time;
  if (state.brake_time < delay) return;
  state.brake_closed = !state.loop_closed;
}

void open_loop(DriveState& state) {
  if (!state.loop_closed) return;
  state.loop_closed = false;
  state.brake_time = 0.0;
}

void watch_gear(const GearData& gear, DriveState& state) {
  const double effort = std::abs(state.gear_effort);
  const bool over = effort > gear.peak_effort;
  if (over && !state.overloaded) ++state.overloads;
  state.overloaded = over;
  state.peak_effort = std::max(state.peak_effort, effort);
}

void hold(DriveState& state, double target) {
  state.holding = true;
  state.hold_target = target;
}

void reset(const DriveData& data, DriveState& state, double target) {
  const bool stopped = has(state, state_bit::kError | state_bit::kHalted);
  state.latched &= ~curable(data, state);
  state.peak_effort = 0.0;
  state.overloads = 0;
  if (!has(state, state_bit::kPowerStage)) state.latched &= ~state_bit::kPowerFault;
  if (!stopped) return;
  hold(state, target);
  if (has(state, state_bit::kPowerFault)) return;
  state.latched &= ~state_bit::kError;
  close_loop(data, state);
}

void halt(DriveState& state, double target) {
  state.latched |= state_bit::kHalted;
  state.homing = false;
  state.motion = {};
  hold(state, target);
}

void home(DriveState& state) {
  if (has(state, state_bit::kError) || !state.loop_closed) return;
  state.latched &= ~state_bit::kHomeOk;
  state.homing = true;
  state.moves_to_zero = false;
  state.motion = {};
}

void set_zero(DriveState& state) {
  shift_zero(state, state.home_offset - state.zero_offset);
  state.offset_in_force = state.home_offset;
}

void apply_home_offset(DriveState& state) {
  shift_zero(state, state.home_offset - state.offset_in_force);
  state.offset_in_force = state.home_offset;
}

void take_from_bus(DriveState& state, const Motion& motion) {
  hold(state, state.commanded);
  state.by_bus = true;
  state.motion = motion;
}

void release_to_ports(DriveState& state) {
  state.by_bus = false;
  state.motion = {};
}

void lose_controller(DriveState& state) {
  trip(state, state_bit::kCommError);
}

std::uint32_t state_word(const DriveState& state) {
  std::uint32_t word = state.latched;
  if (state.motion.in_progress) word |= state_bit::kInProgress;
  if (state.motion.queued) word |= state_bit::kFullBuffer;
  if (state.brake_closed) word |= state_bit::kBrakeActive;
  switch (state.setpoint.phase) {
    case RampPhase::kEnd:
      return word | state_bit::kRampEnd;
    case RampPhase::kAccelerating:
      return word | state_bit::kMotion | state_bit::kRampAcc;
    case RampPhase::kSteady:
      return word | state_bit::kMotion | state_bit::kRampSteady;
    case RampPhase::kDecelerating:
      return word | state_bit::kMotion | state_bit::kRampDec;
  }
  return word;
}

}  // namespace visum::drive

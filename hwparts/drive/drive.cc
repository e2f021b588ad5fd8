#include "hwparts/drive/drive.h"

#include <algorithm>

#include "hwparts/drive/encoder.h"
#include "hwparts/drive/motor.h"
#include "hwparts/drive/servo_loop.h"
#include "hwparts/drive/state_word.h"
#include "hwparts/drive/supervision.h"

namespace visum::drive {

Drive::Drive(const DriveData& data, double position, bool homed, double tick_s)
    : data_(data), tick_s_(tick_s), initial_(initial_state(data, position, homed)), state_(initial_) {}

void Drive::act(const Command& command, std::span<const hwparts::JointSample> joints,
                std::span<hwparts::JointDrive> drives) {
  supervise(data_, state_);
  move_brake(data_.brake, state_, tick_s_);
  move_setpoint(command);
  plan_ = plan_rotor(data_, state_, drive_motor(), tick_s_);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    drives[i] = couple(data_, plan_, state_.rotor_position, joints.size(), joints[i], tick_s_);
  }
  acted_ = true;
}

void Drive::publish(std::span<const hwparts::JointSample> joints) {
  for (std::size_t i = 0; i < joints.size(); ++i) state_.joint_position[i] = joints[i].position;
  if (!acted_) return;
  acted_ = false;
  move_rotor(data_, plan_, joints, tick_s_, state_);
  watch_gear(data_.gear, state_);
  const double measured = quantised(data_, state_.rotor_position);
  state_.measured_speed =
      filtered_speed(data_.loop, state_.measured_speed, measured - state_.measured_position, tick_s_);
  state_.measured_position = measured;
  state_.i2t = advance_i2t(data_.motor, state_.i2t, state_.current, tick_s_);
  state_.winding = advance_winding(data_.motor, state_.winding, state_.current, tick_s_);
}

void Drive::restart() {
  state_ = initial_;
  acted_ = false;
}

void Drive::load(hwparts::StateReader& from) {
  drive::load(state_, from);
  acted_ = false;
}

// Where to: home, to the target, or to a stop; nowhere while the loop is open.
void Drive::move_setpoint(const Command& command) {
  auto& setpoint = state_.setpoint;
  if (!ready(state_)) {
    setpoint = {state_.measured_position, 0.0, RampPhase::kEnd};
    return;
  }
  const double acceleration = state_.tuning.maximum_acceleration;
  if (state_.homing && command.enabled) {
    setpoint = ramp_to(setpoint, data_.home.position, data_.home.speed, acceleration, tick_s_);
    if (setpoint.phase != RampPhase::kEnd) return;
    state_.homing = false;
    state_.latched |= state_bit::kHomeOk;
    hold(state_, command.target);
    return;
  }
  const bool stopped =
      has(state_, state_bit::kError | state_bit::kHalted) || !has(state_, state_bit::kHomeOk);
  if (!stopped && command.enabled && state_.holding) state_.holding = command.target == state_.hold_target;
  const bool follows = !stopped && command.enabled && !state_.holding;
  const double target = follows ? reachable_target(data_, state_, command.target) : 0.0;
  if (follows && !has(state_, state_bit::kError)) {
    const double speed = std::min(command.maximum_speed, data_.limits.maximum_speed);
    setpoint = ramp_to(setpoint, target, speed, acceleration, tick_s_);
  } else {
    setpoint = ramp_stop(setpoint, data_.limits.stop_deceleration, tick_s_);
  }
}

MotorEffort Drive::drive_motor() {
  if (!ready(state_)) {
    state_.current = state_.integral_current = 0.0;
    return {};
  }
  const auto window = current_window(data_, state_.tuning.supply_voltage, state_.rotor_speed);
  const auto command = control_current(data_, state_, window, tick_s_);
  state_.current = command.current;
  state_.integral_current = command.integral;
  if (command.limited) state_.latched |= state_bit::kCurLimit;
  const double slope = data_.effort_per_amp() * data_.effort_per_amp() / data_.motor.resistance;
  return {data_.effort_per_amp() * command.current, command.by_voltage ? slope : 0.0};
}

}  // namespace visum::drive

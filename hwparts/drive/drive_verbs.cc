// The commands of a Drive: ports and field bus change it between ticks by these, and by nothing else.
#include "hwparts/drive/drive.h"
#include "hwparts/drive/encoder.h"
#include "hwparts/drive/state_word.h"
#include "hwparts/drive/supervision.h"

namespace visum::drive {

void Drive::latch(double target) {
  state_.commanded = target;
}

void Drive::reset() {
  drive::reset(data_, state_, state_.commanded);
  known_ &= state_.latched;
}

void Drive::halt() {
  drive::halt(state_, state_.commanded);
}

void Drive::hold() {
  drive::hold(state_, state_.commanded);
}

void Drive::place(std::span<const hwparts::JointSample> joints) {
  state_.rotor_position = state_.rotor_speed = state_.gear_effort = 0.0;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    state_.joint_position[i] = joints[i].position;
    state_.rotor_position += joints[i].position;
    state_.rotor_speed += joints[i].velocity;
  }
  state_.measured_position = encoder(0.0);
  state_.measured_speed = state_.rotor_speed;
  state_.integral_current = state_.current = state_.loop.wanted_current = state_.loop.travel = 0.0;
  state_.setpoint = {state_.measured_position, state_.rotor_speed,
                     state_.rotor_speed == 0.0 ? RampPhase::kEnd : RampPhase::kDecelerating};
  state_.motion = {};
  state_.homing = state_.moves_to_zero = false;
  acted_ = false;
  hold();
}

void Drive::lose_controller() {
  drive::lose_controller(state_);
}

void Drive::open_loop() {
  drive::open_loop(state_);
}

void Drive::home() {
  release_to_ports(state_);
  drive::home(state_);
}

void Drive::cancel_homing_of_ports() {
  state_.homing = state_.homing && state_.by_bus;
}

bool Drive::home_by_bus() {
  if (has(state_, state_bit::kError) || !state_.loop_closed) return false;
  take_from_bus(state_, {});
  drive::home(state_);
  show_motion();
  return true;
}

void Drive::halt_by_bus() {
  halt();
  state_.by_bus = true;
}

void Drive::move_by_bus(const Motion& motion) {
  const bool stays = goes_to_a_place(motion.kind) && motion.target == state_.setpoint.position;
  take_from_bus(state_, motion);
  if (!stays) show_motion();
}

void Drive::step_by_bus(double target, double duration_s) {
  move_by_bus(start_step(state_.motion, state_.setpoint, target, duration_s, motion_limits()));
}

void Drive::queue_step(double target, double duration_s) {
  drive::queue_step(state_.motion, target, duration_s);
}

void Drive::start_queued_step() {
  auto& motion = state_.motion;
  motion = start_step(motion, state_.setpoint, motion.next_target, motion.next_duration_s, motion_limits());
}

void Drive::warn_of_current_limit() {
  state_.latched |= state_bit::kCurLimit;
}

void Drive::tune(double Tuning::*field, double value) {
  state_.tuning.*field = value;
}

void Drive::set_home_offset(double offset) {
  state_.home_offset = offset;
}

void Drive::apply_home_offset() {
  drive::apply_home_offset(state_);
}

void Drive::set_zero_after_home(bool moves) {
  state_.zero_after_home = moves;
}

void Drive::set_homed(bool homed) {
  state_.latched &= ~state_bit::kHomeOk;
  if (homed) state_.latched |= state_bit::kHomeOk;
}

void Drive::count_from_here() {
  state_.referenced = false;
  state_.zero_offset = -quantised(data_, state_.rotor_position);
  state_.measured_position += state_.zero_offset;
  state_.setpoint.position += state_.zero_offset;
}

// A command is answered before the next tick moves the setpoint. Until then the state word shows motion, so
// that a client that asks at once is not told that the motion is over.
void Drive::show_motion() {
  if (state_.setpoint.phase == RampPhase::kEnd) state_.setpoint.phase = RampPhase::kAccelerating;
}

MotionLimits Drive::motion_limits() const {
  return {state_.tuning.maximum_speed, state_.tuning.maximum_acceleration};
}

}  // namespace visum::drive

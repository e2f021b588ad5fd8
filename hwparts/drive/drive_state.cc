#include "hwparts/drive/drive_state.h"

#include "hwparts/drive/encoder.h"
#include "hwparts/drive/state_word.h"

namespace visum::drive {
namespace {

// Calls `visit` for every field once: save() and load() thus agree. StateWriter::put_run() needs it
// inlined.
template <typename State, typename Visit>
[[gnu::always_inline]] inline void visit_fields(State& s, Visit visit) {
  visit(s.rotor_position), visit(s.rotor_speed);
  for (auto& position : s.joint_position) visit(position);
  visit(s.gear_effort);
  visit(s.zero_offset), visit(s.home_offset), visit(s.offset_in_force), visit(s.referenced);
  visit(s.measured_position), visit(s.measured_speed);
  visit(s.setpoint.position), visit(s.setpoint.speed), visit(s.setpoint.phase);
  visit(s.integral_current), visit(s.current);
  visit(s.i2t), visit(s.winding);
  visit(s.latched), visit(s.loop_closed), visit(s.brake_closed), visit(s.brake_time);
  visit(s.homing), visit(s.zero_after_home), visit(s.moves_to_zero);
  visit(s.power_cycled), visit(s.holding), visit(s.hold_target), visit(s.commanded), visit(s.by_bus);
  visit(s.soft_side), visit(s.hard_side);
  visit(s.peak_effort), visit(s.overloads), visit(s.overloaded);
  visit_motion(s.motion, visit);
  auto& t = s.tuning;
  visit(t.position_gain), visit(t.velocity_bandwidth), visit(t.integral_time), visit(t.maximum_acceleration);
  visit(t.following_error), visit(t.soft_minimum), visit(t.soft_maximum), visit(t.supply_voltage);
  visit(t.maximum_speed), visit(t.maximum_current), visit(t.home_speed), visit(t.brake_engage_time);
}

}  // namespace

Tuning initial_tuning(const DriveData& data) {
  Tuning tuning;
  tuning.position_gain = data.loop.position_gain;
  tuning.velocity_bandwidth = data.loop.velocity_bandwidth;
  tuning.integral_time = data.loop.integral_time;
  tuning.maximum_acceleration = data.limits.maximum_acceleration;
  tuning.following_error = data.limits.following_error;
  tuning.soft_minimum = data.limits.soft_minimum;
  tuning.soft_maximum = data.limits.soft_maximum;
  tuning.supply_voltage = data.supply.nominal_voltage;
  tuning.maximum_speed = data.limits.maximum_speed;
  tuning.maximum_current = data.motor.current_limit;
  tuning.home_speed = data.home.speed;
  tuning.brake_engage_time = data.brake.engage_time;
  return tuning;
}

DriveState initial_state(const DriveData& data, double position, bool homed) {
  DriveState state;
  state.rotor_position = position;
  state.measured_position = quantised(data, position);
  state.setpoint.position = position;
  state.commanded = data.speed_controlled ? 0.0 : position;
  state.winding = data.motor.ambient;
  state.latched = homed ? state_bit::kHomeOk : 0;
  state.tuning = initial_tuning(data);
  return state;
}

void save(const DriveState& state, hwparts::StateWriter& to) {
  to.put_run(sizeof state,
             [&](auto& run) { visit_fields(state, [&](const auto& field) { run.put(field); }); });
}

void load(DriveState& state, hwparts::StateReader& from) {
  visit_fields(state, [&](auto& field) { from.get(field); });
}

void save(const LoopSample& loop, hwparts::StateWriter& to) {
  to.put(loop.age), to.put(loop.travel), to.put(loop.wanted_current);
}

void load(LoopSample& loop, hwparts::StateReader& from) {
  from.get(loop.age), from.get(loop.travel), from.get(loop.wanted_current);
}

}  // namespace visum::drive

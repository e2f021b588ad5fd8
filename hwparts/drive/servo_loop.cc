#include "hwparts/drive/servo_loop.h"

#include <algorithm>

namespace visum::drive {

CurrentCommand limit_current(double wanted, double integral, const CurrentWindow& window) {
  CurrentCommand command;
  command.wanted = wanted;
  command.integral = integral;
  command.current = std::clamp(wanted, window.lower, window.upper);
  command.limited = command.current != wanted;
  command.by_voltage =
      command.limited && (wanted > window.upper ? window.upper_by_voltage : window.lower_by_voltage);
  return command;
}

CurrentCommand control_current(const DriveData& data, const DriveState& state, const CurrentWindow& window,
                               double period_s) {
  const auto& tuning = state.tuning;
  const double lag = state.setpoint.position - state.measured_position;
  const double wanted_speed = state.setpoint.speed + tuning.position_gain * lag;
  const double slip = wanted_speed - state.measured_speed;
  const double gain =
      tuning.velocity_bandwidth * data.reflected_inertia() / data.effort_per_amp();  // A per [u]/s

  double integral = tuning.integral_time > 0.0 ? state.integral_current : 0.0;
  auto command = limit_current(gain * slip + integral, integral, window);
  // Anti-windup: a limited command is not integrated further into its limit.
  const bool winds_up = command.limited && slip * command.current > 0.0;
  if (tuning.integral_time > 0.0 && !winds_up) integral += period_s / tuning.integral_time * gain * slip;
  command.integral = std::clamp(integral, -data.motor.current_limit, data.motor.current_limit);
  return command;
}

}  // namespace visum::drive

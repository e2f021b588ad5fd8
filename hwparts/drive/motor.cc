#include "hwparts/drive/motor.h"

#include <algorithm>

namespace visum::drive {
namespace {

constexpr double kFreeAfterTrip = 0.5;  // share of the budget

}  // namespace

CurrentWindow current_window(const DriveData& data, double supply_voltage, double speed) {
  const auto& motor = data.motor;
  const double back_emf = motor.torque_constant * data.gear.ratio * speed;
  const double highest = (supply_voltage - back_emf) / motor.resistance;
  const double lowest = (-supply_voltage - back_emf) / motor.resistance;
  CurrentWindow window;
  window.upper_by_voltage = highest < motor.current_limit;
  window.lower_by_voltage = lowest > -motor.current_limit;
  // Faster than the supply can drive it, a motor brakes, but never with more than its limit.
  window.upper = std::max(-motor.current_limit, std::min(motor.current_limit, highest));
  window.lower = std::min(motor.current_limit, std::max(-motor.current_limit, lowest));
  return window;
}

double advance_i2t(const MotorData& motor, double i2t, double current, double tick_s) {
  const double excess = current * current - motor.nominal_current * motor.nominal_current;
  return std::max(0.0, i2t + tick_s * excess);
}

double i2t_budget(const MotorData& motor) {
  return (motor.current_limit * motor.current_limit - motor.nominal_current * motor.nominal_current) *
         motor.peak_time;
}

double i2t_rest(const MotorData& motor, double i2t) {
  const double excess = i2t - kFreeAfterTrip * i2t_budget(motor);
  return std::max(0.0, excess / (motor.nominal_current * motor.nominal_current));
}

double advance_winding(const MotorData& motor, double winding, double current, double tick_s) {
  const double heated = motor.ambient + current * current * motor.resistance * motor.thermal_resistance;
  return winding + tick_s / (tick_s + motor.thermal_time) * (heated - winding);
}

}  // namespace visum::drive

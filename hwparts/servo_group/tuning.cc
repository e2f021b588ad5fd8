#include "hwparts/servo_group/tuning.h"

#include <array>
#include <cmath>

namespace visum::servo_group {
namespace {

using drive::DriveData;
using drive::Tuning;

// A loop that is sampled every h seconds is stable, with room for torsion and friction, up to these gains.
TuningRange position_gain(const DriveData&, double h) {
  return {0.01, 0.2 / h};
}
TuningRange velocity_bandwidth(const DriveData&, double h) {
  return {0.1, 0.8 / h};
}
TuningRange integral_time(const DriveData&, double) {
  return {0.0, 100.0};
}
TuningRange acceleration(const DriveData& data, double) {
  return {1e-3 * data.limits.maximum_acceleration, data.limits.maximum_acceleration};
}
TuningRange following_error(const DriveData& data, double) {
  return {data.increment(), 1e3};
}
TuningRange soft_limit(const DriveData& data, double) {
  return {data.limits.hard_minimum, data.limits.hard_maximum};
}

constexpr std::array<TuningField, 7> kFields{{
    {"Position Gain", "1/s", "P gain of the position loop", &Tuning::position_gain, position_gain},
    {"Velocity Gain", "1/s", "P gain of the velocity loop, as its bandwidth around the bare rotor",
     &Tuning::velocity_bandwidth, velocity_bandwidth},
    {"Velocity Integral Time", "s", "integral time of the velocity loop; 0: no integral part",
     &Tuning::integral_time, integral_time},
    {"Maximum Acceleration", "<u>/s²", "of the ramps", &Tuning::maximum_acceleration, acceleration},
    {"Following Error Limit", "<u>", "more trips TOW_ERROR", &Tuning::following_error, following_error},
    {"Soft Limit Minimum", "<u>", "a command beyond it trips BEYOND_SOFT", &Tuning::soft_minimum, soft_limit,
     true},
    {"Soft Limit Maximum", "<u>", "a command beyond it trips BEYOND_SOFT", &Tuning::soft_maximum, soft_limit,
     true},
}};

std::string spell(std::string unit, bool linear) {
  const auto at = unit.find("<u>");
  return at == std::string::npos ? unit : unit.replace(at, 3, linear ? "m" : "rad");
}

protocol::Parameter reading(std::string name, std::string unit, std::string help,
                            protocol::ParameterValue value) {
  protocol::Parameter parameter;
  parameter.name = std::move(name);
  parameter.unit = std::move(unit);
  parameter.help = std::move(help);
  parameter.value = std::move(value);
  parameter.read_only = true;
  return parameter;
}

std::optional<std::string> check_soft_limits(const drive::Drive& drive, const Tuning& tuning) {
  if (tuning.soft_minimum >= tuning.soft_maximum) return "the minimum must stay below the maximum";
  const double position = drive.state().measured_position, tolerance = drive.data().limits.tolerance;
  if (position >= tuning.soft_minimum - tolerance && position <= tuning.soft_maximum + tolerance)
    return std::nullopt;
  return "the axis stands at " + std::to_string(position) + ", outside of that";
}

}  // namespace

std::span<const TuningField> tuning_fields() {
  return kFields;
}

void append_parameters(const drive::Drive& drive, std::size_t number, double tick_s,
                       std::vector<protocol::Parameter>& to) {
  const std::string suffix = " " + std::to_string(number);
  const bool linear = drive.data().linear;
  for (const auto& field : kFields) {
    if (field.limit && !drive.data().limits.limited) continue;
    const auto range = field.range(drive.data(), tick_s);
    protocol::Parameter parameter{field.name + suffix, spell(field.unit, linear),
                                  field.help,          drive.state().tuning.*field.member,
                                  range.minimum,       range.maximum};
    to.push_back(std::move(parameter));
  }
  const auto& state = drive.state();
  to.push_back(reading("Winding Temperature" + suffix, "°C", "of the motor", state.winding));
  to.push_back(reading("Gear Peak Load" + suffix, linear ? "N" : "N·m",
                       "largest load of the gear since the last Reset", state.peak_effort));
  to.push_back(reading("Gear Overloads" + suffix, "",
                       "times that the gear's rated peak was exceeded since the last Reset",
                       static_cast<std::int64_t>(state.overloads)));
}

std::optional<std::string> tune(drive::Drive& drive, const TuningField& field, double value, double tick_s) {
  const auto range = field.range(drive.data(), tick_s);
  if (!(value >= range.minimum && value <= range.maximum)) {
    return "must be between " + std::to_string(range.minimum) + " and " + std::to_string(range.maximum);
  }
  Tuning tuning = drive.state().tuning;
  tuning.*field.member = value;
  if (tuning.integral_time > 0.0 && tuning.integral_time < 2.0 * tick_s)
    return "must be 0 or at least two ticks";
  if (field.limit) {
    if (auto reason = check_soft_limits(drive, tuning)) return reason;
  }
  drive.state().tuning = tuning;
  return std::nullopt;
}

}  // namespace visum::servo_group

#include "hwparts/servo_group/tuning.h"

#include <array>
#include <cmath>

namespace visum::servo_group {
namespace {

using drive::DriveData;
using drive::Tuning;

// Up to these gains a loop that is sampled every h seconds is stable, with room for torsion and friction.
TuningRange position_gain(const DriveData& data, double tick_s) {
  return {0.01, 0.2 / data.loop_period(tick_s)};
}
TuningRange velocity_bandwidth(const DriveData& data, double tick_s) {
  return {0.1, 0.8 / data.loop_period(tick_s)};
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
    {"Maximum Acceleration", "<u>/s²", "acceleration of the ramps", &Tuning::maximum_acceleration,
     acceleration, false, 0x4A},
    {"Following Error Limit", "<u>", "a larger following error trips TOW_ERROR", &Tuning::following_error,
     following_error, false, 0x40},
    {"Soft Limit Minimum", "<u>", "a command beyond it trips BEYOND_SOFT", &Tuning::soft_minimum, soft_limit,
     true, 0x45},
    {"Soft Limit Maximum", "<u>", "a command beyond it trips BEYOND_SOFT", &Tuning::soft_maximum, soft_limit,
     true, 0x46},
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

std::optional<std::string> check_soft_limits(const DriveData& data, double position, const Tuning& tuning) {
  if (tuning.soft_minimum >= tuning.soft_maximum) return "the minimum must stay below the maximum";
  const double tolerance = data.limits.tolerance;
  if (position >= tuning.soft_minimum - tolerance && position <= tuning.soft_maximum + tolerance)
    return std::nullopt;
  return "the axis stands at " + std::to_string(position) + ", outside of that";
}

}  // namespace

std::span<const TuningField> tuning_fields() {
  return kFields;
}

protocol::Parameter field_parameter(const TuningField& field, const DriveData& data, const Tuning& tuning,
                                    std::size_t number, double tick_s) {
  const auto range = field.range(data, tick_s);
  return {field.name + (" " + std::to_string(number)),
          spell(field.unit, data.linear),
          field.help,
          tuning.*field.member,
          range.minimum,
          range.maximum};
}

void append_parameters(const drive::Drive& drive, std::size_t number, double tick_s,
                       std::vector<protocol::Parameter>& to) {
  const std::string suffix = " " + std::to_string(number);
  const auto& state = drive.state();
  for (const auto& field : kFields) {
    if (field.limit && !drive.data().limits.limited) continue;
    to.push_back(field_parameter(field, drive.data(), state.tuning, number, tick_s));
  }
  to.push_back(
      reading("Winding Temperature" + suffix, "°C", "temperature of the motor's winding", state.winding));
  to.push_back(reading("Gear Peak Load" + suffix, drive.data().linear ? "N" : "N·m",
                       "largest load of the gear since the last Reset", state.peak_effort));
  to.push_back(reading("Gear Overloads" + suffix, "",
                       "times that the gear's rated peak was exceeded since the last Reset",
                       static_cast<std::int64_t>(state.overloads)));
}

std::optional<std::string> change(const TuningField& field, const DriveData& data, double position,
                                  double value, double tick_s, Tuning& tuning) {
  const auto range = field.range(data, tick_s);
  if (!(value >= range.minimum && value <= range.maximum)) {
    return "must be between " + std::to_string(range.minimum) + " and " + std::to_string(range.maximum);
  }
  Tuning changed = tuning;
  changed.*field.member = value;
  if (changed.integral_time > 0.0 && changed.integral_time < 2.0 * data.loop_period(tick_s))
    return "must be 0 or at least two periods of the loop";
  if (field.limit) {
    if (auto reason = check_soft_limits(data, position, changed)) return reason;
  }
  tuning = changed;
  return std::nullopt;
}

std::optional<std::string> tune(drive::Drive& drive, const TuningField& field, double value, double tick_s) {
  const auto& state = drive.state();
  Tuning changed = state.tuning;
  auto reason = change(field, drive.data(), state.measured_position, value, tick_s, changed);
  if (!reason) drive.tune(field.member, changed.*field.member);
  return reason;
}

}  // namespace visum::servo_group

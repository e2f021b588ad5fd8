// The parameters of a ServoGroup: those of the whole part, then those of each drive (tuning.h), numbered.
#include <algorithm>
#include <cmath>

#include "hwparts/servo_group/servo_group.h"
#include "hwparts/servo_group/tuning.h"

namespace visum::servo_group {

using protocol::kEmergencyStop;
using protocol::kTripped;

namespace {

constexpr const char* kSupplyVoltage = "Supply Voltage";
constexpr const char* kFieldBus = "Field Bus";
using drive::kHighestSupply_v;

protocol::Parameter supply_parameter(double volts) {
  return {kSupplyVoltage,
          "V",
          "supply of the motors; 0 is off; below their minimum the drives switch off (POW_VOLT_ERR)",
          volts,
          0.0,
          kHighestSupply_v};
}

protocol::Parameter flag_parameter(const char* name, const char* help, bool now) {
  protocol::Parameter parameter;
  parameter.name = name;
  parameter.help = help;
  parameter.value = now;
  return parameter;
}

}  // namespace

std::vector<protocol::Parameter> ServoGroup::parameters() const {
  std::vector<protocol::Parameter> all;
  all.push_back(lost_parameter(state_.on_controller_lost));
  all.push_back(supply_parameter(state_.supply_voltage));
  all.push_back(
      flag_parameter(kEmergencyStop, "pressed: takes the supply from all motors", state_.emergency_stop));
  all.push_back(flag_parameter(kFieldBus, "false: the modules' bus is cut, and they hear and answer nothing",
                               modules_.connected()));
  for (std::size_t i = 0; i < axes_.size(); ++i) append_parameters(axes_[i].drive, i + 1, tick_s_, all);
  // Last, as it is younger than the recorded sessions of version 1 of the protocol.
  protocol::Parameter tripped;
  tripped.name = kTripped;
  tripped.help = "the drives in fault: why, with numbers, and what to try; empty: none";
  tripped.value = trip_text();
  tripped.read_only = true;
  all.push_back(tripped);
  return all;
}

std::optional<std::string> ServoGroup::set_parameter(const std::string& name,
                                                     const protocol::ParameterValue& value) {
  if (name == kOnControllerLost) return set_lost(value, state_.on_controller_lost);
  if (name == kEmergencyStop || name == kFieldBus) {
    const auto* flag = std::get_if<bool>(&value);
    if (!flag) return "must be true or false";
    if (name == kFieldBus) modules_.connect(*flag);
    if (name == kEmergencyStop) state_.emergency_stop = *flag;
    supply_drives();
    return std::nullopt;
  }
  for (const auto& parameter : parameters()) {
    if (parameter.name != name) continue;
    if (parameter.read_only) return "'" + name + "' can only be read";
    const double number = as_number(value);
    if (!std::isfinite(number)) return "must be a finite number";
    return name == kSupplyVoltage ? set_supply(number) : set_tuning(name, number);
  }
  return Part::set_parameter(name, value);
}

std::optional<std::string> ServoGroup::set_tuning(const std::string& name, double value) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    for (const auto& field : tuning_fields()) {
      if (name == field.name + (" " + std::to_string(i + 1)))
        return tune(axes_[i].drive, field, value, tick_s_);
    }
  }
  return Part::set_parameter(name, value);
}

std::optional<std::string> ServoGroup::set_supply(double volts) {
  if (volts < 0.0 || volts > kHighestSupply_v) return "must be between 0 and 60 V";
  state_.supply_voltage = volts;
  supply_drives();
  return std::nullopt;
}

void ServoGroup::supply_drives() {
  const bool stopped = state_.emergency_stop || faults_.emergency_stop;
  const double volts = stopped ? 0.0 : std::min(state_.supply_voltage, faults_.most_supply_v);
  for (auto& axis : axes_) axis.drive.tune(&drive::Tuning::supply_voltage, volts);
}

}  // namespace visum::servo_group

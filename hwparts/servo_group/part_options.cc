#include "hwparts/servo_group/part_options.h"

#include <limits>
#include <variant>

namespace visum::servo_group {

PartOptions read_options(const config::Node& entry) {
  entry.allow_only({"name", "kind", "model", "joints", "drives", "on_controller_lost", "homed",
                    "execution_enable", "modules", "bus"});
  PartOptions options;
  if (const auto lost = entry.find("on_controller_lost")) {
    options.on_controller_lost =
        lost->one_of({"stop", "hold"}) == "hold" ? OnControllerLost::kHold : OnControllerLost::kStop;
  }
  options.homed = entry.boolean_or("homed", true);
  if (const auto enable = entry.find("execution_enable")) options.execution_enable = enable->boolean();
  return options;
}

protocol::Parameter lost_parameter(OnControllerLost now) {
  protocol::Parameter parameter;
  parameter.name = kOnControllerLost;
  parameter.help = "what a lost controller does: stop on a ramp with a fault, or hold the last values";
  parameter.value = std::string(now == OnControllerLost::kHold ? "hold" : "stop");
  parameter.choices = {"stop", "hold"};
  return parameter;
}

std::optional<std::string> set_lost(const protocol::ParameterValue& value, OnControllerLost& to) {
  const auto* word = std::get_if<std::string>(&value);
  if (!word || (*word != "stop" && *word != "hold")) return "must be 'stop' or 'hold'";
  to = *word == "hold" ? OnControllerLost::kHold : OnControllerLost::kStop;
  return std::nullopt;
}

double as_number(const protocol::ParameterValue& value) {
  if (const auto* number = std::get_if<double>(&value)) return *number;
  if (const auto* integer = std::get_if<std::int64_t>(&value)) return static_cast<double>(*integer);
  return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace visum::servo_group

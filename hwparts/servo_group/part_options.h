// The options of a group of servos in a scene. Every other key is refused.
#pragma once

#include <optional>
#include <string>

#include "hwparts/part.h"
#include "protocol/part_description.h"

namespace visum::servo_group {

enum class OnControllerLost { kStop, kHold };

struct PartOptions {
  OnControllerLost on_controller_lost = OnControllerLost::kStop;
  bool homed = true;             // false: the drives come up without HOME_OK and move only after Home
  bool execution_enable = true;  // initial value of the port
};

PartOptions read_options(const config::Node& entry);

// The choice `on_controller_lost` as a parameter of the part.
inline constexpr const char* kOnControllerLost = "On Controller Lost";
protocol::Parameter lost_parameter(OnControllerLost now);
// Returns the reason of a refusal; nothing if done.
std::optional<std::string> set_lost(const protocol::ParameterValue& value, OnControllerLost& to);

// A parameter's number, given as a double or as an integer; NaN for every other value.
double as_number(const protocol::ParameterValue& value);

}  // namespace visum::servo_group

// What a scene may say about a group of servos. Every other key is refused.
#pragma once

#include "hwparts/part.h"

namespace visum::servo_group {

enum class OnControllerLost { kStop, kHold };

struct PartOptions {
  OnControllerLost on_controller_lost = OnControllerLost::kStop;
  bool homed = true;             // false: the drives come up without HOME_OK and move only after Home
  bool execution_enable = true;  // initial value of the port
};

PartOptions read_options(const config::Node& entry);

}  // namespace visum::servo_group

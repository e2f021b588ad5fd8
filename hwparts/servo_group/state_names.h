// The words for the sensor outputs `Module State` and `Part State`, as the ports' descriptions carry them.
#pragma once

#include <vector>

#include "protocol/part_description.h"

namespace visum::servo_group {

std::vector<protocol::NumberName> module_state_bits();
std::vector<protocol::NumberName> part_state_names();

}  // namespace visum::servo_group

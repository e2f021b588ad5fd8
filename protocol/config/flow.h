// Writes a value as YAML on one line, which reads back as the same value. Used for reports and for options
// that are passed to other programs.
#pragma once

#include <string>

#include "protocol/config/config.h"

namespace visum::config {

std::string flow(const Node& node);  // {mass: 2, name: "a b", list: [1, 2]}

}  // namespace visum::config

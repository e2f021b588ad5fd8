// A value as YAML on one line, which reads back as the same value: for options of other programs, and
// reports.
#pragma once

#include <string>

#include "protocol/config/config.h"

namespace visum::config {

std::string flow(const Node& node);  // {mass: 2, name: "a b", list: [1, 2]}

}  // namespace visum::config

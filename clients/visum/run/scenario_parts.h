// The readers of a scenario's sections. Each throws config::ConfigError.
#pragma once

#include <string>
#include <vector>

#include "clients/visum/run/scenario.h"

namespace visum::run {

// {distance: {...}, below: 0.01}: one quantity and at least one bound.
Condition read_condition(const config::Node& node);
CheckSpec read_check(const config::Node& node);
ControllerSpec read_controller(const config::Node& node);
TimelineEntry read_timeline_entry(const config::Node& node, const std::vector<ControllerSpec>& controllers);

}  // namespace visum::run

// A WorldModel as MuJoCo's XML. Its solver keeps its defaults: contacts, stops and dry friction are soft, so
// a hinge that friction holds creeps.
#pragma once

#include <string>

#include "server/world/world_model.h"

namespace visum::bench {

// MuJoCo 2.2's reader refuses nesting deeper than about 100, and a chain nests one level per link.
inline constexpr int kMaxMjcfDepth = 90;
int mjcf_depth(const world::WorldModel& model);

// The rows of constraints that MuJoCo keeps room for.
std::size_t mjcf_rows(const world::WorldModel& model);

std::string mjcf(const world::WorldModel& model, const char* integrator);

}  // namespace visum::bench

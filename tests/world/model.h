// A small good world that the tests spoil: ground, a box, an arm of a hinge and a slider, a hull and a mesh.
#pragma once

#include <limits>

#include "server/world/world_model.h"

namespace visum::world::testing {

inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
inline constexpr double kInf = std::numeric_limits<double>::infinity();

WorldModel good_model();

}  // namespace visum::world::testing

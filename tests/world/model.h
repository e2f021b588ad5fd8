// A small good world that the tests spoil: ground, a box, an arm of a hinge and a slider, a hull and a mesh.
#pragma once

#include "server/world/world_model.h"

namespace visum::world::testing {

WorldModel good_model();

}  // namespace visum::world::testing

// Lets the meshes of a model's moving link collide as their convex hulls. Hulls cost less than triangles, and
// two meshes that overlap deeply are driven apart by them.
#pragma once

#include <vector>

#include "server/scene/draft.h"

namespace visum::scene {

// Replaces each mesh that collides, unless it is flat. A mesh that is seen stays as a shape that does not
// collide. Returns how many it has replaced. Throws ConfigError at `place` if the scene has too many
// triangles.
std::size_t take_hulls(Draft& draft, std::vector<world::Shape>& shapes, const config::Place& place);

}  // namespace visum::scene

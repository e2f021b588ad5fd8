// Everything of an X3D scene that is outside of all bodies: shapes, lights, viewpoints, and the robots of
// OpenHRP's prototypes.
#pragma once

#include <set>

#include "server/scene/convert/x3d_shapes.h"

namespace visum::scene {

// Shapes become a fixed body "scenery", but not those `of_bodies`. Returns the number of robots.
std::size_t read_x3d_scenery(Draft& draft, X3dShapes& shapes, const X3dNode& root,
                             const std::set<const X3dNode*>& of_bodies);

}  // namespace visum::scene

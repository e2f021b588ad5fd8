// The convex hull of points, with coplanar triangles joined to polygons.
#pragma once

#include <Eigen/Core>
#include <span>

#include "server/collision/polytope.h"

namespace visum::collision {

// The points must span a volume (world::find_fault checks it). Throws std::runtime_error if they do not.
Polytope make_hull(std::span<const Eigen::Vector3d> points);

}  // namespace visum::collision

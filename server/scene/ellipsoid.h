// An ellipsoid as a closed mesh. Pure function.
#pragma once

#include "server/world/world_model.h"

namespace visum::scene {

// Around the origin, with half axes `radii` [m]. Its vertices lie on the ellipsoid.
world::TriangleMesh ellipsoid_mesh(const Eigen::Vector3d& radii);

}  // namespace visum::scene

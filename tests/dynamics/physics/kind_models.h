// Bodies and curves for joints of all kinds.
#pragma once

#include <string>

#include "tests/dynamics/model_builder.h"

namespace visum::physics {

// A body without a shape, with these principal moments of inertia.
world::BodyId add_bulk(dynamics::testing::ModelBuilder& builder, const std::string& name, double mass_kg,
                       const Eigen::Vector3d& inertia, const world::Pose& X_WB);

// A circle through the origin, its centre at -radius * out. `out` and `along` are unit vectors, perpendicular
// to each other. It has so many points that it is round to 1e-9 of its radius.
world::Curve circle(double radius, const Eigen::Vector3d& out, const Eigen::Vector3d& along);

}  // namespace visum::physics

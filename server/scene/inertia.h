// Mass, centre and inertia of solids: closed forms for the primitives, signed tetrahedra for meshes.
#pragma once

#include <Eigen/Core>
#include <string>

#include "server/world/world_model.h"

namespace visum::scene {

struct MassProperties {
  double mass_kg = 0.0;
  Eigen::Vector3d com = Eigen::Vector3d::Zero();        // m
  Eigen::Matrix3d inertia_C = Eigen::Matrix3d::Zero();  // kg·m², about com
};

// Of a solid with density 1 kg/m³, in the shape's frame. `mesh` is for convex and mesh, which must be closed
// (see solid_fault). A plane has no volume and gives zeros.
MassProperties solid_of(const world::Shape& shape, const world::TriangleMesh* mesh);

// Why a mesh bounds no solid, in words: open, or without volume. Empty: it does.
std::string solid_fault(const world::TriangleMesh& mesh);

MassProperties scaled(const MassProperties& part, double factor);  // as if `factor` times as dense
MassProperties moved(const MassProperties& part, const world::Pose& X_BS);
MassProperties together(const MassProperties& a, const MassProperties& b);  // both in one frame

}  // namespace visum::scene

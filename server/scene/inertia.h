// Mass, centre of mass and inertia of solids: closed forms for primitives, signed tetrahedra for meshes. Pure
// functions.
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

// True if the principal moments are positive and A + B >= C holds within `tolerance`, a share of C.
bool is_of_a_solid(const Eigen::Matrix3d& inertia, double tolerance);

// The properties of a solid of density 1 kg/m³, in the shape's frame. `mesh` is for the kinds convex and
// mesh, and must be closed (see solid_fault). A plane has no volume and gives zeros.
MassProperties solid_of(const world::Shape& shape, const world::TriangleMesh* mesh);

// Says why a mesh encloses no solid (it is open, or has no volume). Empty if it does.
std::string solid_fault(const world::TriangleMesh& mesh);

MassProperties scaled(const MassProperties& part, double factor);  // as if `factor` times as dense
// From the shape's frame S to the body's frame B.
MassProperties moved(const MassProperties& part, const world::Pose& X_BS);
MassProperties together(const MassProperties& a, const MassProperties& b);  // both in the same frame

}  // namespace visum::scene

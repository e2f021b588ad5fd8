// A world's shapes, prepared for collision once and placed anew for each tick.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <vector>

#include "server/collision/gjk.h"
#include "server/collision/mesh.h"
#include "server/collision/penetration.h"
#include "server/collision/prepared_meshes.h"
#include "server/world/world_model.h"
#include "server/world/world_state.h"

namespace visum::collision {

struct PreparedShape {
  world::ShapeId id;
  world::BodyId body;
  world::ShapeKind kind = world::ShapeKind::kBox;
  bool fixed = false;
  bool unmoved = false;  // fixed or kinematic: no contact moves it
  world::Pose X_BS;
  double friction = 0.0, restitution = 0.0, rolling_friction = 0.0, torsional_friction = 0.0;
  std::shared_ptr<const Solid> solid;  // null for planes and meshes
  std::shared_ptr<const Mesh> mesh;    // null for all others
  Eigen::AlignedBox3d box_S;           // around it, in its frame; empty for a plane
  // Set by place():
  Placed placed;              // for planes and meshes only the frame
  Eigen::AlignedBox3d box_W;  // empty if the pose is not finite; not used for a plane
  // How often it has been placed elsewhere, and the body's pose when it was the last time.
  std::uint64_t placements = 0;
  Eigen::Vector3d p_WC = Eigen::Vector3d::Zero();
  Eigen::Quaterniond q_WB = Eigen::Quaterniond::Identity();
  // Set by the stage when it searches near pairs: box_W, widened by how far the body may go before the next
  // search.
  Eigen::AlignedBox3d near_W;
};

// Only the shapes that collide. Takes their meshes and hulls from `meshes`. Throws std::runtime_error for a
// convex hull without volume.
std::vector<PreparedShape> prepare_shapes(const world::WorldModel& model, PreparedMeshes& meshes);

// Sets the pose and the box of a shape. A pose that is not finite gives an empty box, which meets nothing.
// Does nothing if the body has not moved by a bit since the last time.
void place(PreparedShape& shape, const world::WorldModel& model, const world::WorldState& state);

// The box, parallel to the axes, around a box in a rotated frame.
Eigen::AlignedBox3d box_around(const Eigen::AlignedBox3d& box, const Eigen::Matrix3d& R,
                               const Eigen::Vector3d& p);

}  // namespace visum::collision

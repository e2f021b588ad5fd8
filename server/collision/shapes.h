// A world's shapes, prepared for collision once, and placed anew for each tick.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <vector>

#include "server/collision/gjk.h"
#include "server/collision/mesh.h"
#include "server/collision/penetration.h"
#include "server/world/world_model.h"
#include "server/world/world_state.h"

namespace visum::collision {

// What shapes of one mesh have in common, each made once.
struct PreparedMeshes {
  std::vector<std::unique_ptr<const Mesh>> meshes;   // by MeshId; null: no shape is of it
  std::vector<std::unique_ptr<const Convex>> hulls;  // likewise
};

struct PreparedShape {
  world::ShapeId id;
  world::BodyId body;
  world::ShapeKind kind = world::ShapeKind::kBox;
  bool fixed = false;
  world::Pose X_BS;
  double friction = 0.0, restitution = 0.0, rolling_friction = 0.0, torsional_friction = 0.0;
  Convex convex;                  // of all kinds but plane and mesh
  std::unique_ptr<GjkShape> gjk;  // likewise
  const Mesh* mesh = nullptr;     // of a mesh
  Eigen::AlignedBox3d box_S;      // around it, in its frame; empty for a plane
  // By place():
  Placed placed;              // for planes and meshes: the frame only
  Eigen::AlignedBox3d box_W;  // empty where the pose is not finite; a plane's is not used
  // By the stage, when it finds what is near: box_W and how far its body may go until that is done again.
  Eigen::AlignedBox3d near_W;
};

// Only the shapes that collide. Fills `meshes`, which have to outlive them. Throws std::runtime_error for a
// hull without volume.
std::vector<PreparedShape> prepare_shapes(const world::WorldModel& model, PreparedMeshes& meshes);

// Sets the pose and the box of a shape. A pose that is not finite gives an empty box: it meets nothing.
void place(PreparedShape& shape, const world::WorldModel& model, const world::WorldState& state);

// Axes-parallel box around a box in a rotated frame.
Eigen::AlignedBox3d box_around(const Eigen::AlignedBox3d& box, const Eigen::Matrix3d& R,
                               const Eigen::Vector3d& p);

}  // namespace visum::collision

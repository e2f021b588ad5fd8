// Small worlds of two shapes or a few for collision tests.
#pragma once

#include <array>
#include <ostream>
#include <string>
#include <vector>

#include "server/collision/collision.h"
#include "server/world/world_model.h"
#include "server/world/world_state.h"

namespace visum::collision::testing {

using world::Pose;
using world::ShapeKind;

struct ShapeSpec {
  ShapeKind kind;
  std::array<double, 3> size{};

  friend void PrintTo(const ShapeSpec& spec, std::ostream* out) {
    constexpr const char* kNames[] = {"Box", "Sphere", "Cylinder", "Capsule", "Plane", "Convex", "Mesh"};
    *out << kNames[static_cast<int>(spec.kind)];
  }
};

// The corners of a box as points, and as twelve triangles.
world::TriangleMesh box_mesh(const Eigen::Vector3d& lengths);

class SceneBuilder {
 public:
  SceneBuilder();
  // A body of its own with one shape; planes are fixed. Convex and mesh shapes are boxes of `size`.
  world::BodyId add(const ShapeSpec& spec, const Pose& X_WB);
  world::BodyId add_fixed(const ShapeSpec& spec, const Pose& X_WB);

  world::WorldModel model;
};

std::vector<Contact> contacts_of(const world::WorldModel& model);

// a upon b: contacts between the first and the second.
std::vector<Contact> contacts_between(const ShapeSpec& a, const Pose& X_WA, const ShapeSpec& b,
                                      const Pose& X_WB);

Pose at(double x, double y, double z);
Pose at(double x, double y, double z, double angle, const Eigen::Vector3d& axis);

}  // namespace visum::collision::testing

// World models for tests in a few lines.
#pragma once

#include <string>

#include "server/world/world_model.h"

namespace visum::dynamics::testing {

using world::BodyId;
using world::JointId;
using world::Pose;
using world::ShapeKind;

inline Pose at(double x, double y, double z) {
  return {{x, y, z}, Eigen::Quaterniond::Identity()};
}
inline Pose at(double x, double y, double z, double angle, const Eigen::Vector3d& axis) {
  return {{x, y, z}, Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()))};
}

class ModelBuilder {
 public:
  explicit ModelBuilder(const world::EngineSetting& engine);

  world::SurfaceId add_surface(double friction, double restitution);
  BodyId add_ground(world::SurfaceId surface = {0});  // the plane z = 0
  // A solid box, its inertia from its mass. The body's frame is its centre.
  BodyId add_box(const std::string& name, const Eigen::Vector3d& lengths, double mass_kg, const Pose& X_WB,
                 world::SurfaceId surface = {0});
  BodyId add_fixed_box(const std::string& name, const Eigen::Vector3d& lengths, const Pose& X_WB,
                       world::SurfaceId surface = {0});
  // A box that the scene moves, and no engine.
  BodyId add_kinematic_box(const std::string& name, const Eigen::Vector3d& lengths, const Pose& X_WB);
  BodyId add_sphere(const std::string& name, double radius, double mass_kg, const Pose& X_WB,
                    world::SurfaceId surface = {0});
  BodyId add_cylinder(const std::string& name, double radius, double length, double mass_kg,
                      const Pose& X_WB);
  BodyId add_hull(const std::string& name, const std::vector<Eigen::Vector3d>& points, double mass_kg,
                  const Pose& X_WB);
  // A body without a shape: a rotor with the moment of inertia `inertia` about every axis, its centre of mass
  // at its frame.
  BodyId add_rotor(const std::string& name, double mass_kg, double inertia, const Pose& X_WB);

  // Axis in W, through `anchor_W`, with the bodies where they are now. An invalid parent means the world.
  world::Joint& add_joint(const std::string& name, world::JointKind kind, BodyId parent, BodyId child,
                          const Eigen::Vector3d& anchor_W, const Eigen::Vector3d& axis_W);

  world::Body& body(BodyId id) { return model.bodies[id.index()]; }

  world::WorldModel model;

 private:
  BodyId add_body(const std::string& name, double mass_kg, const Eigen::Matrix3d& inertia, const Pose& X_WB);
  void add_shape(BodyId body, ShapeKind kind, const std::array<double, 3>& size, world::SurfaceId surface);
};

}  // namespace visum::dynamics::testing

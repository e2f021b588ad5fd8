#include "tests/dynamics/model_builder.h"

namespace visum::dynamics::testing {
namespace {

Eigen::Matrix3d diagonal(double x, double y, double z) {
  return Eigen::Vector3d(x, y, z).asDiagonal();
}

Eigen::Matrix3d box_inertia(const Eigen::Vector3d& l, double mass_kg) {
  const Eigen::Vector3d s = l.cwiseProduct(l) * mass_kg / 12.0;
  return diagonal(s.y() + s.z(), s.x() + s.z(), s.x() + s.y());
}

}  // namespace

ModelBuilder::ModelBuilder(const world::EngineSetting& engine) {
  model.engines.push_back(engine);
  model.surfaces.push_back({"default", 0.5, 0.0});
}

BodyId ModelBuilder::add_body(const std::string& name, double mass_kg, const Eigen::Matrix3d& inertia,
                              const Pose& X_WB) {
  world::Body body;
  body.name = name;
  body.mass_kg = mass_kg;
  body.inertia_C = inertia;
  body.X_WB = X_WB;
  model.bodies.push_back(body);
  return {static_cast<std::int32_t>(model.bodies.size() - 1)};
}

void ModelBuilder::add_shape(BodyId body, ShapeKind kind, const std::array<double, 3>& size,
                             world::SurfaceId surface) {
  world::Shape shape;
  shape.name = model.bodies[body.index()].name;
  shape.body = body;
  shape.kind = kind;
  shape.size = size;
  shape.surface = surface;
  model.shapes.push_back(shape);
}

world::SurfaceId ModelBuilder::add_surface(double friction, double restitution) {
  model.surfaces.push_back({"surface_" + std::to_string(model.surfaces.size()), friction, restitution});
  return {static_cast<std::int32_t>(model.surfaces.size() - 1)};
}

BodyId ModelBuilder::add_ground(world::SurfaceId surface) {
  const BodyId id = add_body("ground", 0.0, Eigen::Matrix3d::Zero(), {});
  body(id).fixed = true;
  add_shape(id, ShapeKind::kPlane, {}, surface);
  return id;
}

BodyId ModelBuilder::add_box(const std::string& name, const Eigen::Vector3d& lengths, double mass_kg,
                             const Pose& X_WB, world::SurfaceId surface) {
  const BodyId id = add_body(name, mass_kg, box_inertia(lengths, mass_kg), X_WB);
  add_shape(id, ShapeKind::kBox, {lengths.x(), lengths.y(), lengths.z()}, surface);
  return id;
}

BodyId ModelBuilder::add_fixed_box(const std::string& name, const Eigen::Vector3d& lengths, const Pose& X_WB,
                                   world::SurfaceId surface) {
  const BodyId id = add_box(name, lengths, 1.0, X_WB, surface);
  body(id).fixed = true;
  return id;
}

BodyId ModelBuilder::add_kinematic_box(const std::string& name, const Eigen::Vector3d& lengths,
                                       const Pose& X_WB) {
  const BodyId id = add_box(name, lengths, 1.0, X_WB);
  body(id).kinematic = true;
  body(id).engine = world::kNoEngine;
  return id;
}

BodyId ModelBuilder::add_sphere(const std::string& name, double radius, double mass_kg, const Pose& X_WB,
                                world::SurfaceId surface) {
  const double inertia = 0.4 * mass_kg * radius * radius;
  const BodyId id = add_body(name, mass_kg, diagonal(inertia, inertia, inertia), X_WB);
  add_shape(id, ShapeKind::kSphere, {radius}, surface);
  return id;
}

BodyId ModelBuilder::add_cylinder(const std::string& name, double radius, double length, double mass_kg,
                                  const Pose& X_WB) {
  const double across = mass_kg * (3.0 * radius * radius + length * length) / 12.0;
  const BodyId id = add_body(name, mass_kg, diagonal(across, across, 0.5 * mass_kg * radius * radius), X_WB);
  add_shape(id, ShapeKind::kCylinder, {radius, length}, {0});
  return id;
}

BodyId ModelBuilder::add_hull(const std::string& name, const std::vector<Eigen::Vector3d>& points,
                              double mass_kg, const Pose& X_WB) {
  double reach = 0.0;
  for (const Eigen::Vector3d& point : points) reach = std::max(reach, point.norm());
  const double inertia = 0.4 * mass_kg * reach * reach;
  const BodyId id = add_body(name, mass_kg, diagonal(inertia, inertia, inertia), X_WB);
  model.meshes.push_back({name, points, {}});
  add_shape(id, ShapeKind::kConvex, {}, {0});
  model.shapes.back().mesh = {static_cast<std::int32_t>(model.meshes.size() - 1)};
  return id;
}

BodyId ModelBuilder::add_rotor(const std::string& name, double mass_kg, double inertia, const Pose& X_WB) {
  return add_body(name, mass_kg, diagonal(inertia, inertia, inertia), X_WB);
}

world::Joint& ModelBuilder::add_joint(const std::string& name, world::JointKind kind, BodyId parent,
                                      BodyId child, const Eigen::Vector3d& anchor_W,
                                      const Eigen::Vector3d& axis_W) {
  const Pose X_WJ{anchor_W, Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), axis_W)};
  world::Joint joint;
  joint.name = name;
  joint.kind = kind;
  joint.parent = parent;
  joint.child = child;
  joint.X_PJ = parent.valid() ? body(parent).X_WB.inverse() * X_WJ : X_WJ;
  joint.X_CJ = body(child).X_WB.inverse() * X_WJ;
  joint.axis_J = Eigen::Vector3d::UnitZ();
  model.joints.push_back(joint);
  return model.joints.back();
}

}  // namespace visum::dynamics::testing

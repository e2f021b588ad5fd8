#include "tests/world/model.h"

namespace visum::world::testing {
namespace {

Body solid(const std::string& name, double x) {
  Body body;
  body.name = name;
  body.mass_kg = 2.0;
  body.inertia_C = Eigen::Vector3d(0.1, 0.2, 0.25).asDiagonal();
  body.X_WB.p.x() = x;
  return body;
}

Shape shape_on(std::int32_t body, ShapeKind kind, std::array<double, 3> size) {
  Shape shape;
  shape.name = "shape_" + std::to_string(body);
  shape.body = {body};
  shape.kind = kind;
  shape.size = size;
  shape.surface = {0};
  return shape;
}

Joint joint_between(const std::string& name, JointKind kind, BodyId parent, BodyId child) {
  Joint joint;
  joint.name = name;
  joint.kind = kind;
  joint.parent = parent;
  joint.child = child;
  joint.X_PJ.p.x() = 1.0;  // bodies stand a metre apart
  return joint;
}

}  // namespace

WorldModel good_model() {
  WorldModel model;
  model.engines.push_back({"ode"});
  model.engines.push_back({"ode"});
  model.surfaces.push_back({"default"});
  model.meshes.push_back({"tetrahedron",
                          {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                          {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}});
  Body ground;
  ground.name = "ground";
  ground.fixed = true;
  model.bodies = {ground, solid("link_1", 1), solid("link_2", 2), solid("box", 9)};
  model.shapes = {shape_on(0, ShapeKind::kPlane, {}), shape_on(1, ShapeKind::kCylinder, {0.1, 1.0}),
                  shape_on(2, ShapeKind::kConvex, {}), shape_on(3, ShapeKind::kBox, {1, 1, 1})};
  model.shapes[2].mesh = {0};
  model.joints = {joint_between("hinge", JointKind::kHinge, {0}, {1}),
                  joint_between("slider", JointKind::kSlider, {1}, {2})};
  model.no_collision = {{{0}, {1}}, {{1}, {2}}};
  return model;
}

}  // namespace visum::world::testing

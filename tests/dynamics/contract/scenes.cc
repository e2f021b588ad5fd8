#include "tests/dynamics/contract/scenes.h"

namespace visum::dynamics::testing {

using world::JointKind;

world::WorldModel busy_model(const world::EngineSetting& engine) {
  ModelBuilder b(engine);
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(),
                        z = Eigen::Vector3d::UnitZ();
  b.add_ground();
  const BodyId mast = b.add_box("mast", {0.1, 0.1, 0.5}, 3.0, at(0, 0, 0.3));
  const BodyId upper = b.add_box("upper", {0.4, 0.08, 0.08}, 2.0, at(0.2, 0, 0.6));
  const BodyId lower = b.add_box("lower", {0.4, 0.06, 0.06}, 1.0, at(0.6, 0, 0.6));
  const BodyId finger = b.add_box("finger", {0.05, 0.05, 0.2}, 0.2, at(0.8, 0, 0.5));
  b.add_joint("turn", JointKind::kHinge, {}, mast, {0, 0, 0}, z);
  b.add_joint("shoulder", JointKind::kHinge, mast, upper, {0, 0, 0.6}, y);
  b.add_joint("elbow", JointKind::kHinge, upper, lower, {0.4, 0, 0.6}, y);
  world::Joint& slide = b.add_joint("slide", JointKind::kSlider, lower, finger, {0.8, 0, 0.5}, z);
  slide.limited = true;
  slide.lower = -0.1;
  slide.upper = 0.05;
  slide.friction = 0.2;
  slide.damping = 1.0;
  const BodyId tool = b.add_box("tool", {0.02, 0.02, 0.02}, 0.05, at(0.8, 0, 0.4));
  b.add_joint("mount", JointKind::kFixed, finger, tool, {0.8, 0, 0.4}, x);
  for (int i = 0; i < 3; ++i)
    b.add_box("box_" + std::to_string(i), {0.1, 0.12, 0.08}, 0.5,
              at(0.5, 0.02 * i, 0.9 + 0.15 * i, 0.3 * i, {1, 2, 3}));
  b.add_sphere("ball", 0.05, 0.3, at(0.3, 0.05, 1.0));
  b.add_cylinder("can", 0.04, 0.1, 0.4, at(0.62, 0.0, 0.75, 0.5, x));
  return b.model;
}

void make_boxes_sheets(world::WorldModel& model) {
  model.meshes.push_back({"sheet", {{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}}, {{0, 2, 1}, {0, 3, 2}}});
  for (auto& shape : model.shapes) {
    if (shape.kind != world::ShapeKind::kBox) continue;
    shape.kind = world::ShapeKind::kMesh;
    shape.mesh = {static_cast<std::int32_t>(model.meshes.size()) - 1};
    shape.size = {};
  }
}

void set_busy_drives(Lab& lab) {
  lab.drive("turn") = {0.8, 0.01, 20.0, 0.0};
  lab.drive("shoulder") = {-0.2, 1e-3, 30.0, -5.0};
  lab.drive("elbow") = {0.3, 1e-3, 10.0, 0.0};
}

}  // namespace visum::dynamics::testing

#include "tests/collision/scene.h"

namespace visum::collision::testing {

world::TriangleMesh box_mesh(const Eigen::Vector3d& lengths) {
  world::TriangleMesh mesh;
  mesh.name = "box";
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(
        0.5 * lengths.cwiseProduct(Eigen::Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  mesh.triangles = {{1, 3, 7}, {1, 7, 5}, {0, 4, 6}, {0, 6, 2}, {2, 6, 7}, {2, 7, 3},
                    {0, 1, 5}, {0, 5, 4}, {4, 5, 7}, {4, 7, 6}, {0, 2, 3}, {0, 3, 1}};
  return mesh;
}

SceneBuilder::SceneBuilder() {
  model.surfaces.push_back({"default", 0.5, 0.0});
  model.engines.push_back({"ode"});
}

world::BodyId SceneBuilder::add(const ShapeSpec& spec, const Pose& X_WB) {
  const world::BodyId id{static_cast<std::int32_t>(model.bodies.size())};
  world::Body body;
  body.name = "body_" + std::to_string(id.value);
  body.fixed = spec.kind == ShapeKind::kPlane;
  body.mass_kg = 1.0;
  body.inertia_C = Eigen::Matrix3d::Identity();
  body.X_WB = X_WB;
  model.bodies.push_back(body);
  world::Shape shape;
  shape.name = body.name;
  shape.body = id;
  shape.kind = spec.kind;
  shape.size = spec.size;
  shape.surface = {0};
  if (spec.kind == ShapeKind::kConvex || spec.kind == ShapeKind::kMesh) {
    shape.mesh = {static_cast<std::int32_t>(model.meshes.size())};
    model.meshes.push_back(box_mesh({spec.size[0], spec.size[1], spec.size[2]}));
  }
  model.shapes.push_back(shape);
  return id;
}

world::BodyId SceneBuilder::add_fixed(const ShapeSpec& spec, const Pose& X_WB) {
  const world::BodyId id = add(spec, X_WB);
  model.bodies[id.index()].fixed = true;
  return id;
}

std::vector<Contact> contacts_of(const world::WorldModel& model) {
  CollisionStage stage(model);
  std::vector<Contact> contacts;
  stage.find(initial_state(model), contacts);
  return contacts;
}

std::vector<Contact> contacts_between(const ShapeSpec& a, const Pose& X_WA, const ShapeSpec& b,
                                      const Pose& X_WB) {
  SceneBuilder scene;
  scene.add(a, X_WA);
  scene.add(b, X_WB);
  return contacts_of(scene.model);
}

Pose at(double x, double y, double z) {
  return {{x, y, z}, Eigen::Quaterniond::Identity()};
}

Pose at(double x, double y, double z, double angle, const Eigen::Vector3d& axis) {
  return {{x, y, z}, Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()))};
}

}  // namespace visum::collision::testing

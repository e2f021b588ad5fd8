#include <cmath>
#include <string>

#include "tests/dynamics/model_builder.h"
#include "tests/dynamics/physics/loop_models.h"

namespace visum::physics {
namespace {

using Eigen::Vector3d;

// Along the edges of a cube, from corner to corner; the edge from the last to the first is the ground.
const Vector3d kCorners[] = {{0, 0, 0}, {1, 0, 0}, {1, -1, 0}, {1, -1, 1}, {0, -1, 1}, {0, 0, 1}};
constexpr int kCount = 6;

Vector3d edge(int i) {
  return kCorners[(i + 1) % kCount] - kCorners[i % kCount];
}

// A box of 1 x 0.1 x 0.1 m and 1 kg.
world::Body rod(int i) {
  const Vector3d along = edge(i).cwiseAbs();
  world::Body body;
  body.name = "rod_" + std::to_string(i);
  body.mass_kg = 1.0;
  body.inertia_C = (1.01 / 12.0 * (Vector3d::Ones() - along) + 0.02 / 12.0 * along).asDiagonal();
  body.X_WB.p = kCorners[i] + 0.5 * edge(i);
  return body;
}

}  // namespace

world::WorldModel bricard(const world::EngineSetting& engine, double tick_s) {
  dynamics::testing::ModelBuilder b(engine);
  b.model.tick_ns = std::llround(1e9 * tick_s);
  for (int i = 0; i < kCount - 1; ++i) b.model.bodies.push_back(rod(i));
  // Each axis is perpendicular to the edges that meet there.
  for (int i = 0; i < kCount; ++i) {
    const world::BodyId before{i - 1}, after{i < kCount - 1 ? i : -1};
    const Vector3d axis = edge(i + kCount - 1).cross(edge(i));
    const bool closes = !after.valid();
    b.add_joint("hinge_" + std::to_string(i), world::JointKind::kHinge, closes ? world::BodyId{} : before,
                closes ? before : after, kCorners[i], axis);
  }
  return b.model;
}

}  // namespace visum::physics

#include "tests/dynamics/physics/kind_models.h"

#include <cmath>
#include <numbers>
#include <vector>

namespace visum::physics {

using Eigen::Vector3d;

world::BodyId add_bulk(dynamics::testing::ModelBuilder& builder, const std::string& name, double mass_kg,
                       const Vector3d& inertia, const world::Pose& X_WB) {
  const world::BodyId id = builder.add_rotor(name, mass_kg, 1.0, X_WB);
  builder.body(id).inertia_C = inertia.asDiagonal();
  return id;
}

world::Curve circle(double radius, const Vector3d& out, const Vector3d& along) {
  constexpr int kPoints = 240;
  std::vector<Vector3d> points;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kPoints;
    points.push_back(radius * ((std::cos(angle) - 1.0) * out + std::sin(angle) * along));
  }
  return {points, true};
}

}  // namespace visum::physics

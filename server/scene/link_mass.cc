#include "server/scene/link_mass.h"

#include <Eigen/Geometry>
#include <cstdio>

namespace visum::scene {
namespace {

constexpr double kBallRadiusM = 0.05;
constexpr double kBallMassKg = 0.1;
constexpr double kLeastVolume = 1e-12;        // m³: a tenth of a millimetre each way
constexpr double kMinThicknessM = 1e-4;       // of the box around a flat mesh
constexpr double kInertiaTolerance = 0.5e-6;  // stricter than world::find_fault's

MassProperties box_around(const world::TriangleMesh& mesh) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : mesh.vertices) box.extend(vertex);
  const Eigen::Vector3d sides = box.sizes().cwiseMax(kMinThicknessM);
  world::Shape shape;
  shape.kind = world::ShapeKind::kBox;
  shape.size = {sides[0], sides[1], sides[2]};
  return moved(solid_of(shape, nullptr), {box.center(), Eigen::Quaterniond::Identity()});
}

MassProperties solid_in_body(const world::Shape& shape, const std::vector<world::TriangleMesh>& meshes) {
  const world::TriangleMesh* mesh = shape.mesh.valid() ? &meshes[shape.mesh.index()] : nullptr;
  const bool open = mesh != nullptr && !solid_fault(*mesh).empty();
  return moved(open ? box_around(*mesh) : solid_of(shape, mesh), shape.X_BS);
}

MassProperties solid_of_shapes(const std::vector<world::Shape>& shapes, bool collides,
                               const std::vector<world::TriangleMesh>& meshes) {
  MassProperties sum;
  for (const world::Shape& shape : shapes)
    if (shape.collides == collides) sum = together(sum, solid_in_body(shape, meshes));
  return sum;
}

MassProperties ball() {
  world::Shape shape;
  shape.kind = world::ShapeKind::kSphere;
  shape.size = {kBallRadiusM, 0, 0};
  const MassProperties solid = solid_of(shape, nullptr);
  return scaled(solid, kBallMassKg / solid.mass_kg);
}

std::string kilograms(double mass) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g kg", mass);
  return text;
}

}  // namespace

RepairedMass repaired_mass(const MassProperties& given, const std::vector<world::Shape>& shapes,
                           const std::vector<world::TriangleMesh>& meshes, double density) {
  const bool has_mass = given.mass_kg > 0.0;
  if (has_mass && is_of_a_solid(given.inertia_C, kInertiaTolerance)) return {given, ""};
  MassProperties solid = solid_of_shapes(shapes, true, meshes);
  if (solid.mass_kg < kLeastVolume) solid = solid_of_shapes(shapes, false, meshes);
  const bool has_volume = solid.mass_kg >= kLeastVolume && is_of_a_solid(solid.inertia_C, kInertiaTolerance);
  if (!has_volume) solid = ball();
  if (has_mass) {
    RepairedMass repaired{scaled(solid, given.mass_kg / solid.mass_kg), ""};
    repaired.mass.com = given.com;
    repaired.repair =
        has_volume ? "has the inertia of its shapes" : "has the inertia of a ball of 5 cm radius";
    return repaired;
  }
  if (!has_volume) return {solid, "moves without mass and shapes: it is a ball of 5 cm radius and 0.1 kg"};
  const MassProperties filled = scaled(solid, density);
  return {filled, "moves without mass: its shapes of " + std::to_string(static_cast<long>(density)) +
                      " kg/m³ give it " + kilograms(filled.mass_kg)};
}

}  // namespace visum::scene

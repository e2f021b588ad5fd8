#include "server/scene/ellipsoid.h"

#include <numbers>

#include "server/world/turn.h"

namespace visum::scene {
namespace {

constexpr std::uint32_t kRings = 15;    // between the poles
constexpr std::uint32_t kSectors = 24;  // of a ring

// A point of the unit sphere: rings count from 1 at the upper pole.
Eigen::Vector3d on_sphere(std::uint32_t ring, std::uint32_t sector) {
  using Eigen::Vector3d;
  const Vector3d tilted =
      world::turn_about(Vector3d::UnitY(), std::numbers::pi * ring / (kRings + 1)) * Vector3d::UnitZ();
  return world::turn_about(Vector3d::UnitZ(), 2 * std::numbers::pi * sector / kSectors) * tilted;
}

}  // namespace

world::TriangleMesh ellipsoid_mesh(const Eigen::Vector3d& radii) {
  world::TriangleMesh mesh;
  mesh.name = "ellipsoid";
  mesh.vertices = {{0, 0, radii.z()}, {0, 0, -radii.z()}};
  for (std::uint32_t ring = 1; ring <= kRings; ++ring)
    for (std::uint32_t sector = 0; sector < kSectors; ++sector)
      mesh.vertices.push_back(on_sphere(ring, sector).cwiseProduct(radii));
  const auto at = [](std::uint32_t ring, std::uint32_t sector) {
    return 2 + (ring - 1) * kSectors + sector % kSectors;
  };
  for (std::uint32_t sector = 0; sector < kSectors; ++sector) {
    mesh.triangles.push_back({0, at(1, sector), at(1, sector + 1)});
    mesh.triangles.push_back({1, at(kRings, sector + 1), at(kRings, sector)});
    for (std::uint32_t ring = 1; ring < kRings; ++ring) {
      mesh.triangles.push_back({at(ring, sector), at(ring + 1, sector), at(ring + 1, sector + 1)});
      mesh.triangles.push_back({at(ring, sector), at(ring + 1, sector + 1), at(ring, sector + 1)});
    }
  }
  return mesh;
}

}  // namespace visum::scene

#include "server/scene/mjcf/meshes.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "server/scene/mesh_readers.h"

namespace visum::scene::mjcf {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kLeastVolume = 1e-15;  // m³

std::array<Vector3d, 3> corners(const world::TriangleMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  return {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
}

Vector3d middle_of_surface(const world::TriangleMesh& mesh) {
  Vector3d sum = Vector3d::Zero();
  double area = 0.0;
  for (const auto& triangle : mesh.triangles) {
    const auto [a, b, c] = corners(mesh, triangle);
    const double here = (b - a).cross(c - a).norm() / 2;
    area += here;
    sum += here * (a + b + c) / 3;
  }
  return area > 0 ? Vector3d(sum / area) : Vector3d::Zero();
}

// Six times the volume under a triangle, seen from the origin.
double six_volumes(const std::array<Vector3d, 3>& t, bool exact) {
  const double volume = t[0].dot(t[1].cross(t[2]));
  return exact ? volume : std::abs(volume);
}

}  // namespace

MassProperties solid_of_mesh(const world::TriangleMesh& mesh, bool exact) {
  const Vector3d middle = middle_of_surface(mesh);
  double volume = 0.0;
  Vector3d first = Vector3d::Zero();
  for (const auto& triangle : mesh.triangles) {
    auto t = corners(mesh, triangle);
    for (Vector3d& corner : t) corner -= middle;
    const double v = six_volumes(t, exact) / 6;
    volume += v;
    first += v * (t[0] + t[1] + t[2]) / 4;
  }
  if (std::abs(volume) < kLeastVolume) return {};
  const Vector3d com = middle + first / volume;
  Matrix3d second = Matrix3d::Zero();
  double about_com = 0.0;
  for (const auto& triangle : mesh.triangles) {
    auto t = corners(mesh, triangle);
    for (Vector3d& corner : t) corner -= com;
    const double v = six_volumes(t, exact) / 6;
    about_com += v;
    const Vector3d s = t[0] + t[1] + t[2];
    second +=
        v / 20 *
        (t[0] * t[0].transpose() + t[1] * t[1].transpose() + t[2] * t[2].transpose() + s * s.transpose());
  }
  if (about_com < 0) {  // all faces turned inside out
    about_com = -about_com;
    second = -second;
  }
  return {about_com, com, second.trace() * Matrix3d::Identity() - second};
}

world::TriangleMesh read_msh(std::string_view bytes, const config::Place& place) {
  const auto refuse = [&](const std::string& why) {
    throw config::ConfigError(place, "the mesh file " + why);
  };
  std::array<std::int32_t, 4> counts{};  // vertices, normals, texture coordinates, faces
  if (bytes.size() < sizeof counts) refuse("is too short");
  std::memcpy(counts.data(), bytes.data(), sizeof counts);
  for (const std::int32_t count : counts)
    if (count < 0 || count > static_cast<std::int32_t>(world::kMaxTriangles) * 3)
      refuse("gives a wrong count");
  const auto count = [&](std::size_t i) { return static_cast<std::size_t>(counts[i]); };
  const std::size_t size = sizeof counts + 4 * (3 * count(0) + 3 * count(1) + 2 * count(2) + 3 * count(3));
  if (bytes.size() != size)
    refuse("has " + std::to_string(bytes.size()) + " bytes, not " + std::to_string(size));
  const char* const vertices = bytes.data() + sizeof counts;
  const char* const faces = bytes.data() + size - 12 * count(3);
  MeshBuilder builder(place.file);
  for (std::size_t i = 0; i < count(3); ++i) {
    std::array<std::int32_t, 3> face{};
    std::memcpy(face.data(), faces + 12 * i, sizeof face);
    std::array<Vector3d, 3> triangle;
    for (std::size_t k = 0; k < 3; ++k) {
      if (face[k] < 0 || face[k] >= counts[0]) refuse("has a face with a vertex that does not exist");
      std::array<float, 3> p{};
      std::memcpy(p.data(), vertices + 12 * static_cast<std::size_t>(face[k]), sizeof p);
      triangle[k] = {p[0], p[1], p[2]};
    }
    builder.add(triangle, 0);
  }
  return builder.take();
}

}  // namespace visum::scene::mjcf

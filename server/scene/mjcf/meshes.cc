#include "server/scene/mjcf/meshes.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <map>

#include "server/scene/mesh_readers.h"

namespace visum::scene::mjcf {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kLeastVolume = 1e-15;  // m³
constexpr int kBallSplits = 3;

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

// Replaces each triangle by four, with new vertices on the unit sphere.
void split(world::TriangleMesh& ball) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
  const auto middle = [&](std::uint32_t a, std::uint32_t b) {
    const auto [entry, is_new] = middles.try_emplace({std::min(a, b), std::max(a, b)},
                                                     static_cast<std::uint32_t>(ball.vertices.size()));
    if (is_new) ball.vertices.push_back((ball.vertices[a] + ball.vertices[b]).normalized());
    return entry->second;
  };
  std::vector<std::array<std::uint32_t, 3>> finer;
  for (const auto& [a, b, c] : ball.triangles) {
    const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  ball.triangles = std::move(finer);
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

world::TriangleMesh ball_mesh() {
  world::TriangleMesh ball;
  ball.name = "ball";
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) ball.vertices.push_back(sign * Vector3d::Unit(axis));
  ball.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int i = 0; i < kBallSplits; ++i) split(ball);
  return ball;
}

world::TriangleMesh thin_hull(const world::TriangleMesh& mesh) {
  if (mesh.vertices.size() <= kMaxHullVertices) return mesh;
  static const world::TriangleMesh directions = ball_mesh();
  world::TriangleMesh thin;
  thin.name = mesh.name + " (hull)";
  std::map<std::size_t, std::uint32_t> kept;
  std::vector<std::uint32_t> farthest;
  for (const Vector3d& direction : directions.vertices) {
    std::size_t best = 0;
    double most = -1e300;
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      const double here = direction.dot(mesh.vertices[i]);
      if (here > most) {
        most = here;
        best = i;
      }
    }
    const auto [entry, is_new] = kept.try_emplace(best, static_cast<std::uint32_t>(thin.vertices.size()));
    if (is_new) thin.vertices.push_back(mesh.vertices[best]);
    farthest.push_back(entry->second);
  }
  for (const auto& [a, b, c] : directions.triangles)
    if (farthest[a] != farthest[b] && farthest[b] != farthest[c] && farthest[c] != farthest[a])
      thin.triangles.push_back({farthest[a], farthest[b], farthest[c]});
  return thin;
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

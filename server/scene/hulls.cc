#include "server/scene/hulls.h"

#include <Eigen/Eigenvalues>
#include <map>

namespace visum::scene {
namespace {

using Eigen::Vector3d;

constexpr int kBallSplits = 3;

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

bool is_flat(const world::TriangleMesh& mesh) {
  Vector3d mean = Vector3d::Zero();
  for (const Vector3d& vertex : mesh.vertices) mean += vertex / static_cast<double>(mesh.vertices.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Vector3d& vertex : mesh.vertices) spread += (vertex - mean) * (vertex - mean).transpose();
  const Vector3d lengths = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues();
  return mesh.vertices.size() < 4 || lengths[0] <= 1e-8 * lengths[2];
}

}  // namespace visum::scene

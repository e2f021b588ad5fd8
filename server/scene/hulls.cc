#include "server/scene/hulls.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

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

// Finds the vertex that is farthest in a direction. Files keep neighbours together, so runs of vertices lie
// in small boxes, and only few boxes reach far enough to be looked into.
class Farthest {
 public:
  explicit Farthest(const std::vector<Vector3d>& vertices) : vertices_(vertices) {
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (i % kRun == 0) boxes_.emplace_back();
      boxes_.back().extend(vertices[i]);
      largest_ = std::max(largest_, vertices[i].lpNorm<1>());
    }
    reaches_.resize(boxes_.size());
  }

  // The first one, if there are several.
  std::size_t along(const Vector3d& unit) {
    for (std::size_t run = 0; run < boxes_.size(); ++run) {
      const auto& low = boxes_[run].min();
      const auto& high = boxes_[run].max();
      reaches_[run] = kRounding * largest_;
      for (int i = 0; i < 3; ++i) reaches_[run] += std::max(unit[i] * low[i], unit[i] * high[i]);
    }
    const auto promising = std::max_element(reaches_.begin(), reaches_.end()) - reaches_.begin();
    double most = -kNone;
    std::size_t best = 0;
    look_into(static_cast<std::size_t>(promising), unit, most, best);
    // From here on the vertices are met in their order, those that are as far among them.
    most = std::nextafter(most, -kNone);
    for (std::size_t run = 0; run < boxes_.size(); ++run)
      if (reaches_[run] > most) look_into(run, unit, most, best);
    return best;
  }

 private:
  static constexpr std::size_t kRun = 32;
  static constexpr double kRounding = 1e-14;  // share of the coordinates; some ten roundings
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  void look_into(std::size_t run, const Vector3d& unit, double& most, std::size_t& best) const {
    const std::size_t end = std::min(vertices_.size(), (run + 1) * kRun);
    for (std::size_t i = run * kRun; i < end; ++i) {
      const double here = unit.dot(vertices_[i]);
      if (here <= most) continue;
      most = here;
      best = i;
    }
  }

  const std::vector<Vector3d>& vertices_;
  std::vector<Eigen::AlignedBox3d> boxes_;  // of kRun vertices each
  std::vector<double> reaches_;             // of the boxes in a direction, and a little more
  double largest_ = 0.0;
};

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
  Farthest vertices(mesh.vertices);
  for (const Vector3d& direction : directions.vertices) {
    const std::size_t best = vertices.along(direction);
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

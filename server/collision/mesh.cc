#include "server/collision/mesh.h"

#include <algorithm>
#include <map>

namespace visum::collision {
namespace {

constexpr double kLeastDoubleAreaM2 = 1e-16;

Eigen::AlignedBox3d box_of(const MeshTriangle& triangle) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& corner : triangle.corners) box.extend(corner);
  return box;
}

// Where the middle of its box lies on an axis.
double centre(const MeshTriangle& triangle, Eigen::Index axis) {
  const auto [least, most] =
      std::minmax({triangle.corners[0][axis], triangle.corners[1][axis], triangle.corners[2][axis]});
  return (least + most) / 2.0;
}

struct EdgeSide {
  std::size_t triangle, edge;
};

// An edge by the places of its two ends, since files often repeat their vertices.
struct EdgeKey {
  std::array<double, 6> ends;

  EdgeKey(const Eigen::Vector3d& from, const Eigen::Vector3d& to)
      : ends{from.x(), from.y(), from.z(), to.x(), to.y(), to.z()} {}
  bool operator<(const EdgeKey& other) const { return ends < other.ends; }
};

// Sets `across` of every edge that has a neighbour.
void find_neighbours(std::vector<MeshTriangle>& triangles) {
  std::map<EdgeKey, EdgeSide> sides;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i)
      sides.emplace(EdgeKey(triangles[t].corners[i], triangles[t].corners[(i + 1) % 3]), EdgeSide{t, i});
  }
  for (const auto& [key, side] : sides) {
    MeshTriangle& triangle = triangles[side.triangle];
    const Eigen::Vector3d& from = triangle.corners[side.edge];
    const Eigen::Vector3d& to = triangle.corners[(side.edge + 1) % 3];
    const auto other = sides.find(EdgeKey(to, from));
    if (other == sides.end()) continue;
    const MeshTriangle& neighbour = triangles[other->second.triangle];
    triangle.across[side.edge] = neighbour.normal.cross((from - to).normalized());
  }
}

}  // namespace

Mesh::Mesh(const world::TriangleMesh& mesh) {
  for (const auto& corners : mesh.triangles) {
    MeshTriangle triangle;
    for (std::size_t i = 0; i < 3; ++i) triangle.corners[i] = mesh.vertices[corners[i]];
    const Eigen::Vector3d area =
        (triangle.corners[1] - triangle.corners[0]).cross(triangle.corners[2] - triangle.corners[0]);
    if (!(area.norm() > kLeastDoubleAreaM2)) continue;
    triangle.normal = area.normalized();
    triangle.across.fill(-triangle.normal);
    triangles_.push_back(triangle);
  }
  find_neighbours(triangles_);
  if (triangles_.empty()) return;
  nodes_.emplace_back();
  split(0, 0, static_cast<std::uint32_t>(triangles_.size()));
}

// Halves the triangles at the median of their centres along the longest axis.
void Mesh::split(std::uint32_t node, std::uint32_t first, std::uint32_t last) {
  Eigen::AlignedBox3d box;
  for (std::uint32_t i = first; i < last; ++i) box.extend(box_of(triangles_[i]));
  nodes_[node].box = box;
  nodes_[node].first = first;
  nodes_[node].count = last - first;
  if (last - first <= kLeafSize) return;
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::uint32_t middle = first + (last - first) / 2;
  // The sort is stable, so that equal centres keep the file's order with every library.
  std::stable_sort(
      triangles_.begin() + first, triangles_.begin() + last,
      [axis](const MeshTriangle& a, const MeshTriangle& b) { return centre(a, axis) < centre(b, axis); });
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].first = children;
  nodes_[node].count = 0;
  split(children, first, middle);
  split(children + 1, middle, last);
}

}  // namespace visum::collision

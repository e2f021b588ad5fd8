#include "server/collision/mesh.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "server/world/point_numbers.h"

namespace visum::collision {
namespace {

constexpr double kLeastDoubleAreaM2 = 1e-16;

Eigen::AlignedBox3d box_of(const MeshTriangle& triangle) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& corner : triangle.corners) box.extend(corner);
  return box;
}

// An edge by the numbers of its two ends.
std::uint64_t edge_key(std::uint32_t from, std::uint32_t to) {
  return std::uint64_t{from} << 32 | to;
}

struct EdgeHash {
  std::size_t operator()(std::uint64_t edge) const { return XXH3_64bits(&edge, sizeof edge); }
};

// Sets `across` of every edge that has a neighbour. Where edges repeat, the first counts.
void find_neighbours(std::vector<MeshTriangle>& triangles) {
  world::PointNumbers places;  // files often repeat their vertices
  std::vector<std::array<std::uint32_t, 3>> corners(triangles.size());
  std::unordered_map<std::uint64_t, std::uint32_t, EdgeHash> sides;  // the triangle of an edge; never walked
  sides.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) corners[t][i] = places.number(triangles[t].corners[i]);
    for (std::size_t i = 0; i < 3; ++i)
      sides.try_emplace(edge_key(corners[t][i], corners[t][(i + 1) % 3]), t);
  }
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = corners[t][i], to = corners[t][(i + 1) % 3];
      if (sides.at(edge_key(from, to)) != t) continue;
      const auto other = sides.find(edge_key(to, from));
      if (other == sides.end()) continue;
      const Eigen::Vector3d back = triangles[t].corners[i] - triangles[t].corners[(i + 1) % 3];
      triangles[t].across[i] = triangles[other->second].normal.cross(back.normalized());
    }
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
  Building building;
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    building.boxes.push_back(box_of(triangles_[t]));
    building.order.push_back(t);
  }
  building.keyed.resize(triangles_.size());
  nodes_.emplace_back();
  split(building, 0, 0, static_cast<std::uint32_t>(triangles_.size()));
  std::vector<MeshTriangle> ordered;
  ordered.reserve(triangles_.size());
  for (const std::uint32_t t : building.order) ordered.push_back(triangles_[t]);
  triangles_ = std::move(ordered);
}

// Halves the triangles at the median of their centres along the longest axis.
void Mesh::split(Building& building, std::uint32_t node, std::uint32_t first, std::uint32_t last) {
  auto& [boxes, order, keyed] = building;
  Eigen::AlignedBox3d box;
  for (std::uint32_t i = first; i < last; ++i) box.extend(boxes[order[i]]);
  nodes_[node].box = box;
  nodes_[node].first = first;
  nodes_[node].count = last - first;
  if (last - first <= kLeafSize) return;
  Eigen::Index axis = 0;
  box.sizes().maxCoeff(&axis);
  const std::uint32_t middle = first + (last - first) / 2;
  // The sort is stable, so that equal centres keep the file's order with every library.
  for (std::uint32_t i = first; i < last; ++i)
    keyed[i] = {(boxes[order[i]].min()[axis] + boxes[order[i]].max()[axis]) / 2.0, order[i]};
  std::stable_sort(keyed.begin() + first, keyed.begin() + last,
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  for (std::uint32_t i = first; i < last; ++i) order[i] = keyed[i].second;
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node].first = children;
  nodes_[node].count = 0;
  split(building, children, first, middle);
  split(building, children + 1, middle, last);
}

}  // namespace visum::collision

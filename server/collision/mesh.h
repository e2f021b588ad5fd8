// A triangle mesh ready for collision: its triangles in a tree of boxes, and what is known of their edges. In
// the shape's frame. Built once, read only afterwards.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

#include "server/world/world_model.h"

namespace visum::collision {

struct MeshTriangle {
  std::array<Eigen::Vector3d, 3> corners;
  Eigen::Vector3d normal;  // unit, by the winding
  // Edge i runs from corner i to i + 1. How the surface goes on beyond it: unit, in the neighbour's plane and
  // square to the edge; straight down at the mesh's border.
  std::array<Eigen::Vector3d, 3> across;

  // A sharp edge (convex, or at the mesh's border) may push sideways; a flat or hollow one may not: what
  // slides over it must not stumble.
  bool is_sharp(std::size_t edge) const { return normal.dot(across[edge]) <= -kSharpSine; }

  static constexpr double kSharpSine = 0.02;  // about one degree
};

class Mesh {
 public:
  explicit Mesh(const world::TriangleMesh& mesh);  // triangles without area are left out

  const std::vector<MeshTriangle>& triangles() const { return triangles_; }

  // Calls visit(triangle index) for the triangles in boxes for which hits(box) is true, always in the same
  // order.
  template <typename Hits, typename Visit>
  void visit(Hits&& hits, Visit&& visit_one) const {
    std::array<std::uint32_t, kMaxDepth> stack;
    std::size_t depth = 0;
    if (!nodes_.empty()) stack[depth++] = 0;
    while (depth > 0) {
      const Node& node = nodes_[stack[--depth]];
      if (!hits(node.box)) continue;
      for (std::uint32_t i = 0; i < node.count; ++i) visit_one(node.first + i);
      if (node.count > 0) continue;
      stack[depth++] = node.first + 1;
      stack[depth++] = node.first;
    }
  }

 private:
  static constexpr std::size_t kMaxDepth = 64;  // halving: 2 million triangles need 22
  static constexpr std::uint32_t kLeafSize = 4;

  // A leaf has triangles first..first+count; an inner node has children first and first + 1.
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t first = 0, count = 0;
  };

  void split(std::uint32_t node, std::uint32_t first, std::uint32_t last);

  std::vector<MeshTriangle> triangles_;  // in the order of the tree
  std::vector<Node> nodes_;
};

}  // namespace visum::collision

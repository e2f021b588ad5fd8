// A triangle mesh ready for collision: its triangles in a tree of boxes, and what is known of their edges. In
// the shape's frame. Built once, then only read.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "server/world/world_model.h"

namespace visum::collision {

struct MeshTriangle {
  std::array<Eigen::Vector3d, 3> corners;
  Eigen::Vector3d normal;  // unit, by the winding
  // Edge i runs from corner i to corner i + 1. `across` is how the surface goes on beyond it: a unit vector
  // in the neighbour's plane, square to the edge. At the mesh's border it points straight down.
  std::array<Eigen::Vector3d, 3> across;

  // A sharp edge (convex, or at the mesh's border) may push sideways. A flat or hollow edge may not, so that
  // a body sliding over it does not stumble.
  bool is_sharp(std::size_t edge) const { return normal.dot(across[edge]) <= -kSharpSine; }

  static constexpr double kSharpSine = 0.02;  // about one degree
};

// A PreparedMeshes owns it. Constant after construction, so any thread may read it.
class Mesh {
 public:
  explicit Mesh(const world::TriangleMesh& mesh);  // leaves out triangles without area

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
  static constexpr std::size_t kMaxDepth = 64;  // the tree halves: 2 million triangles need 22
  static constexpr std::uint32_t kLeafSize = 4;

  // A leaf has the triangles first..first+count-1, an inner node the children first and first + 1.
  struct Node {
    Eigen::AlignedBox3d box;
    std::uint32_t first = 0, count = 0;
  };

  // The tree is built from these small keys; the triangles are put in order at the end.
  struct Building {
    std::vector<Eigen::AlignedBox3d> boxes;  // by triangle
    std::vector<std::uint32_t> order;        // the triangles, as the tree has them
    std::vector<std::pair<double, std::uint32_t>> keyed;
  };
  // Builds the node of the triangles that are first to last-1 in order, and its children.
  void split(Building& building, std::uint32_t node, std::uint32_t first, std::uint32_t last);

  std::vector<MeshTriangle> triangles_;  // in the order of the tree
  std::vector<Node> nodes_;
};

}  // namespace visum::collision

// Nearest points of two segments, each given by one or two points.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "server/collision/convex.h"

namespace visum::collision {

struct PointPair {
  Eigen::Vector3d on_a, on_b;
};

struct PointPairs {
  std::array<PointPair, 2> pairs;
  std::size_t count = 0;

  const PointPair* begin() const { return pairs.data(); }
  const PointPair* end() const { return pairs.data() + count; }
};

// One pair of points, or two for parallel segments that run beside each other: the ends of the stretch that
// they share.
PointPairs nearest_points(const Polygon& a, const Polygon& b);

}  // namespace visum::collision

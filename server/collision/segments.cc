#include "server/collision/segments.h"

#include <Eigen/Geometry>

#include <algorithm>

namespace visum::collision {
namespace {

constexpr double kParallelSineSquared = 1e-4;

// A segment; a point has a span of zero. Places on it are shares of the span, 0 to 1.
struct Segment {
  Eigen::Vector3d from, span;

  explicit Segment(const Polygon& polygon) : from(polygon.points[0]), span(Eigen::Vector3d::Zero()) {
    if (polygon.count > 1) span = polygon.points[1] - from;
  }
  Eigen::Vector3d at(double share) const { return from + share * span; }
  bool is_point() const { return span.squaredNorm() == 0.0; }
  double nearest(const Eigen::Vector3d& point) const {
    return is_point() ? 0.0 : std::clamp(span.dot(point - from) / span.squaredNorm(), 0.0, 1.0);
  }
};

// Ericson, Real-Time Collision Detection (2005), 5.1.9.
PointPair nearest(const Segment& a, const Segment& b) {
  const Eigen::Vector3d r = a.from - b.from;
  const double aa = a.span.squaredNorm(), bb = b.span.squaredNorm(), ab = a.span.dot(b.span);
  const double denominator = aa * bb - ab * ab;
  double share = 0.0;
  if (denominator > kParallelSineSquared * aa * bb)
    share = std::clamp((ab * b.span.dot(r) - a.span.dot(r) * bb) / denominator, 0.0, 1.0);
  const Eigen::Vector3d on_b = b.at(b.nearest(a.at(share)));
  return {a.at(a.nearest(on_b)), on_b};
}

bool are_parallel(const Segment& a, const Segment& b) {
  if (a.is_point() || b.is_point()) return false;
  return a.span.cross(b.span).squaredNorm() <=
         kParallelSineSquared * a.span.squaredNorm() * b.span.squaredNorm();
}

}  // namespace

PointPairs nearest_points(const Polygon& polygon_a, const Polygon& polygon_b) {
  const Segment a(polygon_a), b(polygon_b);
  PointPairs result;
  // Parallel: the ends of b, seen from a.
  if (are_parallel(a, b)) {
    const double s = a.nearest(b.at(0.0)), t = a.nearest(b.at(1.0));
    for (const double share : {s, t})
      result.pairs[result.count++] = {a.at(share), b.at(b.nearest(a.at(share)))};
    if (s != t) return result;
    result.count = 0;
  }
  result.pairs[result.count++] = nearest(a, b);
  return result;
}

}  // namespace visum::collision

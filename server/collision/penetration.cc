#include "server/collision/penetration.h"

#include <limits>

#include "server/collision/boxes.h"
#include "server/collision/gjk.h"

namespace visum::collision {
namespace {

// Shapes nearer than this may get no direction from GJK, although it has found one before. A gap is shortened
// by it.
constexpr double kGjkSlackM = 1e-3;
// Edges and found directions must be better than a face by this factor and length.
constexpr double kFaceBonus = 0.95;
constexpr double kFaceSlackM = 1e-6;

bool has_few_axes(const Convex& convex) {
  return convex.family == Family::kPolytope && convex.polytope.normals.size() <= kMaxSatDirections &&
         convex.polytope.edges.size() <= kMaxSatDirections;
}

// The better of an axis' two senses.
struct Least {
  double depth = std::numeric_limits<double>::infinity();
  Eigen::Vector3d normal_W = Eigen::Vector3d::Zero();
  double gap = 0.0;  // along the axis that separates them

  // Takes both senses of an axis. Returns false once the shapes are found apart.
  bool take(const Placed& a, const Placed& b, const Eigen::Vector3d& axis_W) {
    for (const Eigen::Vector3d& direction : {axis_W, Eigen::Vector3d(-axis_W)}) {
      const double overlap = overlap_along(a, b, direction);
      if (overlap <= 0.0) gap = -overlap;
      if (overlap <= 0.0) return false;
      if (overlap < depth) *this = {overlap, direction};
    }
    return true;
  }
};

// Exact: all face normals of both, and all pairs of edges.
Direction along_separating_axes(const Placed& a, const Placed& b) {
  Least face, edge;
  for (const Placed* side : {&a, &b}) {
    for (const Eigen::Vector3d& normal : side->convex->polytope.normals) {
      if (!face.take(a, b, side->R * normal)) return Direction::apart_by(face.gap);
    }
  }
  for (const Eigen::Vector3d& edge_a : a.convex->polytope.edges) {
    for (const Eigen::Vector3d& edge_b : b.convex->polytope.edges) {
      const Eigen::Vector3d axis = (a.R * edge_a).cross(b.R * edge_b);
      if (axis.squaredNorm() > kParallelSquared && !edge.take(a, b, axis.normalized()))
        return Direction::apart_by(edge.gap);
    }
  }
  const Least& best = is_better(edge.depth, face.depth) ? edge : face;
  return {false, best.normal_W, best.depth};
}

// Used where GJK and EPA both fail: the best among the axes of both frames and the line of centres.
std::optional<Eigen::Vector3d> along_frames(const Placed& a, const Placed& b) {
  Least least;
  for (const Placed* side : {&a, &b}) {
    for (Eigen::Index i = 0; i < 3; ++i) {
      if (!least.take(a, b, side->R.col(i))) return std::nullopt;
    }
  }
  const Eigen::Vector3d line = a.center() - b.center();
  if (line.squaredNorm() > 0.0 && !least.take(a, b, line.normalized())) return std::nullopt;
  return least.normal_W;
}

// GJK's direction is often only near the true one, which is the normal of the face or side that a shape
// offers. For round shapes GJK is exact, and a face must be better.
Direction prefer_features(const Placed& a, const Placed& b, const Direction& found) {
  Direction best{false, found.normal_W, std::numeric_limits<double>::infinity()};
  bool round = false;
  for (const Placed* side : {&a, &b}) {
    const double sign = side == &a ? -1.0 : 1.0;
    round |= side->convex->family == Family::kRound;
    if (side->convex->family == Family::kRound) continue;
    const Eigen::Vector3d looks = sign * (side->R.transpose() * found.normal_W);
    const Eigen::Vector3d candidate = sign * (side->R * side->convex->feature(looks).normal);
    const double depth = overlap_along(a, b, candidate);
    if (depth <= 0.0) return {};
    if (depth < best.depth) best = {false, candidate, depth};
  }
  const double bar = round ? found.depth : found.depth / kFaceBonus + kFaceSlackM;
  return best.depth <= bar ? best : found;
}

}  // namespace

bool is_better(double edge_depth, double face_depth) {
  return edge_depth < kFaceBonus * face_depth - kFaceSlackM;
}

double overlap_along(const Placed& a, const Placed& b, const Eigen::Vector3d& direction_W) {
  return direction_W.dot(b.farthest(direction_W) - a.farthest(-direction_W));
}

Direction find_direction(const Placed& a, const Placed& b, GjkSolver& solver) {
  if (is_box(*a.convex) && is_box(*b.convex)) return find_direction_of_boxes(a, b);
  if (has_few_axes(*a.convex) && has_few_axes(*b.convex)) return along_separating_axes(a, b);
  auto normal = solver.separating_direction(a, b);
  if (!normal) normal = along_frames(a, b);
  if (!normal) return {};
  const Direction found{false, *normal, overlap_along(a, b, *normal)};
  return found.depth > 0.0 ? prefer_features(a, b, found)
                           : Direction::apart_by(-found.depth - kGjkSlackM, found.normal_W);
}

}  // namespace visum::collision

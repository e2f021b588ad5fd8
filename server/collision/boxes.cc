#include "server/collision/boxes.h"

#include <limits>

namespace visum::collision {
namespace {

// A smaller overlap does not count: rounding would let some corners of a face touch and others not.
constexpr double kTouchM = 1e-12;
// A face of a is preferred to a face of b that is better by less than this. Where two faces lie on each
// other, rounding would otherwise choose another one in each tick, with the corners of the other box.
constexpr double kTieM = 1e-8;

// An axis: the normal of a face of a (column of A), of a face of b, or a pair of edges.
struct Axis {
  double depth = std::numeric_limits<double>::infinity();
  double side = 0.0;  // distance along the axis from a to b
  Eigen::Index of_a = -1, of_b = -1;

  // The unit direction in W in which a is pushed.
  Eigen::Vector3d direction(const Placed& a, const Placed& b) const {
    const Eigen::Vector3d axis = of_b < 0 ? Eigen::Vector3d(a.R.col(of_a))
                                          : (of_a < 0 ? Eigen::Vector3d(b.R.col(of_b))
                                                      : a.R.col(of_a).cross(b.R.col(of_b)).normalized());
    return side > 0.0 ? Eigen::Vector3d(-axis) : axis;
  }
};

// Symbols: A, B are the boxes' frames, R = A^T B, t leads from a to b in A, f and g are half the lengths of a
// and b.
struct TwoBoxes {
  Eigen::Matrix3d R, magnitudes;
  Eigen::Vector3d t, f, g;

  TwoBoxes(const Placed& a, const Placed& b)
      : R(a.R.transpose() * b.R),
        magnitudes(R.cwiseAbs()),
        t(a.R.transpose() * (b.p - a.p)),
        f(a.convex->polytope.box),
        g(b.convex->polytope.box) {}

  // Takes an axis if it is the best so far. Returns false if it separates the boxes; it is then the best.
  static bool take(Axis& best, const Axis& axis, double margin = 0.0) {
    const bool parts = axis.depth <= kTouchM;
    if (parts || axis.depth < best.depth - margin) best = axis;
    return !parts;
  }

  // The six face normals.
  bool take_faces(Axis& best) const {
    const Eigen::Vector3d reach_b = magnitudes * g, reach_a = magnitudes.transpose() * f;
    const Eigen::Vector3d t_B = R.transpose() * t;
    for (Eigen::Index i = 0; i < 3; ++i)
      if (!take(best, {f[i] + reach_b[i] - std::abs(t[i]), t[i], i, -1})) return false;
    for (Eigen::Index j = 0; j < 3; ++j)
      if (!take(best, {g[j] + reach_a[j] - std::abs(t_B[j]), t_B[j], -1, j}, kTieM)) return false;
    return true;
  }

  // The nine pairs of edges. A_i x B_j, in A, is 0 at i, -R_kj at i+1 and R_lj at i+2, with l = i+1 and k =
  // i+2.
  bool take_edges(Axis& best) const {
    for (Eigen::Index i = 0; i < 3; ++i) {
      const Eigen::Index l = (i + 1) % 3, k = (i + 2) % 3;
      for (Eigen::Index j = 0; j < 3; ++j) {
        const double squared = R(k, j) * R(k, j) + R(l, j) * R(l, j);
        if (squared <= kParallelSquared) continue;
        const Eigen::Index m = (j + 1) % 3, n = (j + 2) % 3;
        const double reach_a = f[l] * magnitudes(k, j) + f[k] * magnitudes(l, j);
        const double reach_b = g[m] * magnitudes(i, n) + g[n] * magnitudes(i, m);
        const double side = t[k] * R(l, j) - t[l] * R(k, j);
        const double depth = (reach_a + reach_b - std::abs(side)) / std::sqrt(squared);
        if (!take(best, {depth, side, i, j})) return false;
      }
    }
    return true;
  }
};

}  // namespace

bool is_box(const Convex& convex) {
  return convex.polytope.box[0] > 0.0;
}

Direction find_direction_of_boxes(const Placed& a, const Placed& b) {
  const TwoBoxes boxes(a, b);
  Axis face, edge;
  if (!boxes.take_faces(face)) return Direction::apart_by(-face.depth);
  if (!boxes.take_edges(edge)) return Direction::apart_by(-edge.depth);
  const Axis& best = is_better(edge.depth, face.depth) ? edge : face;
  return {false, best.direction(a, b), best.depth};
}

}  // namespace visum::collision

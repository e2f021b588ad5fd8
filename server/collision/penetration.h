// Whether two convex shapes overlap, and along which direction least. Pairs of solids with few faces are
// asked along all their separating axes, which is exact. All others go through FCL's GJK on cores that are a
// little smaller than the shapes: while only the skins overlap, the cores' nearest points give the direction
// well; once the cores overlap too, FCL's EPA does. Neither answer is trusted: overlap_along() measures what
// the direction is worth.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>

#include "server/collision/convex.h"

namespace visum::collision {

class GjkShape;  // FCL's view of a shape (gjk.h)

// A convex shape at a place. R is the rotation matrix of the shape's frame in W.
struct Placed {
  const Convex* convex = nullptr;
  const GjkShape* gjk = nullptr;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d p = Eigen::Vector3d::Zero();

  Eigen::Vector3d farthest(const Eigen::Vector3d& direction_W) const {
    return p + R * convex->farthest(R.transpose() * direction_W);
  }
  Eigen::Vector3d center() const { return p + R * convex->center; }
};

// How deep a and b overlap along a unit direction: how far a must go along it to be free. Negative: apart.
double overlap_along(const Placed& a, const Placed& b, const Eigen::Vector3d& direction_W);

struct Direction {
  bool apart = true;         // the shapes do not touch; of the rest only `gap` is then set
  Eigen::Vector3d normal_W;  // unit, from b to a
  double depth = 0.0;        // overlap_along(normal_W)
  double gap = 0.0;          // they are this far apart, or farther; 0 or less: not known

  static Direction apart_by(double gap) { return {.gap = gap}; }
};

inline constexpr double kParallelSquared = 1e-8;  // of the sine of two edges that give no axis
// Whether a pair of edges is preferred to a face: only if it is better by some margin, so that a contact of
// faces does not flicker.
bool is_better(double edge_depth, double face_depth);

class GjkSolver;
Direction find_direction(const Placed& a, const Placed& b, GjkSolver& solver);

}  // namespace visum::collision

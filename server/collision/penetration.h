// Finds out if two convex shapes overlap, and in which direction least. Pairs of solids with few faces are
// tested along all of their separating axes, which is exact. All other pairs go through FCL's GJK with cores
// that are a little smaller than the shapes. While only the skins overlap, the nearest points of the cores
// give a good direction; once the cores overlap, too, FCL's EPA gives it. Neither answer is trusted:
// overlap_along() measures the overlap along the direction.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>

#include "server/collision/convex.h"

namespace visum::collision {

class GjkShape;  // FCL's view of a shape (gjk.h)

// A convex shape at a place. R is the rotation matrix of its frame in W.
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

// Overlap of a and b along a unit direction, m: how far a must be pushed along it to be free. Negative:
// apart.
double overlap_along(const Placed& a, const Placed& b, const Eigen::Vector3d& direction_W);

// The direction of the least overlap.
struct Direction {
  bool apart = true;         // the shapes do not touch
  Eigen::Vector3d normal_W;  // unit, from b to a. Apart: along it the shapes are `gap` apart, or it is zero
  double depth = 0.0;        // overlap_along(normal_W)
  double gap = 0.0;          // m, they are at least this far apart; 0 or less: not known

  static Direction apart_by(double gap, const Eigen::Vector3d& normal_W = Eigen::Vector3d::Zero()) {
    return {.normal_W = normal_W, .gap = gap};
  }
};

inline constexpr double kParallelSquared =
    1e-8;  // squared sine of the angle between two edges that give no axis
// True if a pair of edges is preferred to a face. It must be better by some margin, so that a contact of
// faces does not flicker.
bool is_better(double edge_depth, double face_depth);

class GjkSolver;
Direction find_direction(const Placed& a, const Placed& b, GjkSolver& solver);

}  // namespace visum::collision

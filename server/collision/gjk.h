// FCL's GJK and EPA on our shapes. Memory is allocated at construction only.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "server/collision/penetration.h"

namespace visum::collision {

// FCL's view of one convex shape: the shape itself and its core (penetration.h).
class GjkShape {
 public:
  explicit GjkShape(const Convex& convex);
  ~GjkShape();
  GjkShape(GjkShape&&) noexcept;

  // Only for a shape that was made from make_triangle().
  void set_triangle(const std::array<Eigen::Vector3d, 3>& corners);

  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

// One GJK and EPA with their memory. NarrowPhase owns it; tick's thread.
class GjkSolver {
 public:
  GjkSolver();
  ~GjkSolver();

  // The unit direction in W in which a must be pushed to be free of b. Nothing if neither algorithm succeeds.
  std::optional<Eigen::Vector3d> separating_direction(const Placed& a, const Placed& b);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace visum::collision

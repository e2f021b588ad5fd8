// FCL's GJK and EPA on our shapes. The only place that sees FCL. Allocates at construction only.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "server/collision/penetration.h"

namespace visum::collision {

// FCL's view of one convex shape: itself, and its core.
class GjkShape {
 public:
  explicit GjkShape(const Convex& convex);
  ~GjkShape();
  GjkShape(GjkShape&&) noexcept;

  void set_triangle(const std::array<Eigen::Vector3d, 3>& corners);  // of one made from make_triangle()

  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

class GjkSolver {
 public:
  GjkSolver();
  ~GjkSolver();

  // The unit direction in W in which a should be pushed to be free of b; nothing where neither algorithm
  // succeeds.
  std::optional<Eigen::Vector3d> separating_direction(const Placed& a, const Placed& b);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace visum::collision

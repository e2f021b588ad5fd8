// A smooth curve through points: the cubic spline of continuous curvature over the length of its chords
// (natural ends, or closed). Immutable once made.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace visum::world {

class Curve {
 public:
  // A place on the curve with its first two derivatives by the parameter.
  struct Place {
    Eigen::Vector3d p, tangent, bend;
  };

  Curve() = default;
  // At least 2 points (closed: 3), neighbours apart; anything else leaves the curve empty.
  Curve(const std::vector<Eigen::Vector3d>& points, bool closed);

  bool empty() const { return points_.empty(); }
  bool closed() const { return closed_; }
  double length() const { return empty() ? 0.0 : knots_.back(); }  // largest parameter, m of chords
  const std::vector<Eigen::Vector3d>& points() const { return points_; }

  // Closed curves go round and round; open ones go on straight beyond their ends.
  Place at(double u) const;
  // The parameter of the nearest place that Newton finds from `u`.
  double nearest(const Eigen::Vector3d& p, double u) const;
  // The parameter of the nearest place of all.
  double nearest(const Eigen::Vector3d& p) const;

 private:
  std::vector<Eigen::Vector3d> points_;  // closed: the first once more at the end
  std::vector<double> knots_;            // by point: the length of chords up to it
  std::vector<Eigen::Vector3d> bends_;   // by point: second derivative
  bool closed_ = false;
};

}  // namespace visum::world

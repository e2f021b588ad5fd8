// A smooth curve through points: the cubic spline with continuous curvature, whose parameter is the length of
// the chords, m. Its ends are natural (no curvature), or it is closed. Immutable once made; any thread.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace visum::world {

class Curve {
 public:
  // A place on the curve, with the first two derivatives by the parameter.
  struct Place {
    Eigen::Vector3d p, tangent, bend;
  };

  Curve() = default;
  // Needs at least 2 points (closed: 3), and neighbours apart. Otherwise the curve stays empty.
  Curve(const std::vector<Eigen::Vector3d>& points, bool closed);

  bool empty() const { return points_.empty(); }
  bool closed() const { return closed_; }
  double length() const { return empty() ? 0.0 : knots_.back(); }  // largest parameter, m of chords
  const std::vector<Eigen::Vector3d>& points() const { return points_; }

  // The place at parameter `u`. Closed curves repeat; open ones go on straight beyond their ends.
  Place at(double u) const;
  // The parameter of the place nearest to `p` that Newton's method finds from `u`: a local answer, cheap
  // enough for each tick.
  double nearest(const Eigen::Vector3d& p, double u) const;
  // The parameter of the nearest place of the whole curve: tries 8 starts per chord.
  double nearest(const Eigen::Vector3d& p) const;

 private:
  std::vector<Eigen::Vector3d> points_;  // closed: ends with the first point again
  std::vector<double> knots_;            // by point: the length of the chords before it
  std::vector<Eigen::Vector3d> bends_;   // by point: second derivative
  bool closed_ = false;
};

}  // namespace visum::world

// The values of a check over a run, in few points. If there are too many steps, neighbours share a point,
// which keeps their lowest and highest value.
#pragma once

#include <cstddef>
#include <vector>

namespace visum::run {

struct CoursePoint {
  double at_s = 0.0;  // of its first step
  double lowest = 0.0, highest = 0.0;
  bool operator==(const CoursePoint&) const = default;
};

class Course {
 public:
  static constexpr std::size_t kMaxPoints = 256;  // even

  void add(double at_s, double value);  // a value that is not finite leaves a gap
  const std::vector<CoursePoint>& points() const { return points_; }

 private:
  void halve();

  std::vector<CoursePoint> points_;
  std::size_t steps_per_point_ = 1;
  std::size_t in_last_ = 0;  // steps in the last point
};

}  // namespace visum::run

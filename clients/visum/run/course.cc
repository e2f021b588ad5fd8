#include "clients/visum/run/course.h"

#include <algorithm>
#include <cmath>

namespace visum::run {
namespace {

void join(CoursePoint& to, double lowest, double highest) {
  to.lowest = std::min(to.lowest, lowest);
  to.highest = std::max(to.highest, highest);
}

}  // namespace

void Course::add(double at_s, double value) {
  if (!std::isfinite(value)) return;
  if (!points_.empty() && in_last_ < steps_per_point_) {
    join(points_.back(), value, value);
    ++in_last_;
    return;
  }
  if (points_.size() == kMaxPoints) halve();
  points_.push_back({at_s, value, value});
  in_last_ = 1;
}

void Course::halve() {
  for (std::size_t i = 0; i < points_.size() / 2; ++i) {
    points_[i] = points_[2 * i];
    join(points_[i], points_[2 * i + 1].lowest, points_[2 * i + 1].highest);
  }
  points_.resize(points_.size() / 2);
  steps_per_point_ *= 2;
}

}  // namespace visum::run

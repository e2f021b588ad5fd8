#include "clients/examples/pick_and_place/trajectory.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace visum::pick_and_place {

Trajectory::Trajectory(JointPath path, const MotionLimits& limits) : path_(std::move(path)) {
  progress_at_.push_back(0.0);
  for (std::size_t i = 1; i < path_.size(); ++i) {
    const auto step = (path_[i] - path_[i - 1]).cwiseAbs();
    progress_at_.push_back(progress_at_.back() + step.cwiseQuotient(limits.speed).maxCoeff());
  }
  const double total = progress_at_.back();
  acceleration_ = limits.acceleration.cwiseQuotient(limits.speed).minCoeff();
  // total = a ramp^2 + (a ramp) steady, with the top rate a ramp at most 1.
  ramp_s_ = std::min(1.0 / acceleration_, std::sqrt(total / acceleration_));
  const double top_rate = acceleration_ * ramp_s_;
  steady_s_ = top_rate > 0.0 ? std::max(0.0, total / top_rate - ramp_s_) : 0.0;
}

double Trajectory::progress(double time_s) const {
  const double t = std::clamp(time_s, 0.0, duration_s());
  if (t < ramp_s_) return 0.5 * acceleration_ * t * t;
  const double left = duration_s() - t;
  if (left < ramp_s_) return progress_at_.back() - 0.5 * acceleration_ * left * left;
  return acceleration_ * ramp_s_ * (t - 0.5 * ramp_s_);
}

double Trajectory::progress_rate(double time_s) const {
  const double from_ends = std::min(time_s, duration_s() - time_s);
  return acceleration_ * std::clamp(from_ends, 0.0, ramp_s_);
}

MotionState Trajectory::at(double time_s) const {
  const double p = progress(time_s);
  const auto after = std::upper_bound(progress_at_.begin() + 1, progress_at_.end(), p);
  const auto i = std::size_t(std::min(after, progress_at_.end() - 1) - progress_at_.begin());
  const double span = i == 0 ? 0.0 : progress_at_[i] - progress_at_[i - 1];
  if (span <= 0.0) return {path_.back(), Eigen::VectorXd::Zero(path_.back().size())};
  const Eigen::VectorXd direction = (path_[i] - path_[i - 1]) / span;
  const double within = std::clamp(p - progress_at_[i - 1], 0.0, span);
  return {path_[i - 1] + within * direction, progress_rate(time_s) * direction};
}

}  // namespace visum::pick_and_place

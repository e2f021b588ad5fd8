#include "clients/examples/quadruped/motion.h"

#include <Eigen/Geometry>

#include "protocol/config/trig.h"

namespace visum::quadruped {
namespace {

constexpr double kUpCorrection_per_s = 1.0;  // how fast the felt acceleration corrects the vertical
constexpr double kVelocityFilter_per_s = 60.0;

// The trunk's velocity, if the point at which this leg touches the ground does not move.
Vector3d velocity_by(const Leg& leg, const Vector3d& angles, const Vector3d& speeds, const Vector3d& rate,
                     const Vector3d& up) {
  const Vector3d to_ground = -kFootRadius * up;
  const Vector3d against_trunk = jacobian(leg, angles) * speeds + shank_rate(angles, speeds).cross(to_ground);
  return -against_trunk - rate.cross(foot(leg, angles) + to_ground);
}

}  // namespace

void Motion::update(const Readings& now, const std::array<bool, kLegs>& stands, bool at_rest) {
  if (at_rest) offset_ += (now.rate - offset_) / ++rests_;  // the mean of all readings at rest
  rate_ = at_rest ? Vector3d::Zero() : Vector3d(now.rate - offset_);

  // The vertical stands still in the world, so it turns against the trunk. Slowly it follows the
  // acceleration that is felt, whose mean is upwards.
  up_ += kCycle * up_.cross(rate_);
  const double felt = now.acceleration.norm();
  if (felt > 1.0) up_ += kCycle * kUpCorrection_per_s * (now.acceleration / felt - up_);
  up_.normalize();
  heading_ += kCycle * rate_.dot(up_);

  Vector3d sum = Vector3d::Zero();
  int standing = 0;
  for (int i = 0; i < kLegs; ++i) {
    if (!stands[i]) continue;
    sum += velocity_by(kLeg[i], now.angles[i], now.speeds[i], rate_, up_);
    ++standing;
  }
  if (standing > 0) velocity_ += kCycle * kVelocityFilter_per_s * (sum / standing - velocity_);
  const auto [sine, cosine] = config::sin_cos(heading_);
  way_ += kCycle * (cosine * velocity_.x() - sine * velocity_.y());
  drift_ += kCycle * (sine * velocity_.x() + cosine * velocity_.y());
}

}  // namespace visum::quadruped

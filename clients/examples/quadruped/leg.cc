#include "clients/examples/quadruped/leg.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "protocol/config/trig.h"

namespace visum::quadruped {
namespace {

// Between thigh axis and foot. The knee's range, -2.6 to -0.3 rad, allows 0.107 to 0.395 m.
constexpr double kShortest = 0.12, kLongest = 0.39;

// A vector of the leg's plane, turned by the hip's angle about x.
Vector3d turned(double hip, const Vector3d& v) {
  const auto [s, c] = config::sin_cos(hip);
  return {v.x(), v.y() * c - v.z() * s, v.y() * s + v.z() * c};
}

// A link that hangs down at angle 0, turned by `angle` about y.
Vector3d link(double angle) {
  const auto [s, c] = config::sin_cos(angle);
  return {-kLink * s, 0.0, -kLink * c};
}

}  // namespace

Vector3d foot(const Leg& leg, const Vector3d& angles) {
  const Vector3d offset(0.0, leg.thigh_offset, 0.0);
  return leg.hip + turned(angles[0], offset + link(angles[1]) + link(angles[1] + angles[2]));
}

Vector3d angles_for(const Leg& leg, const Vector3d& place) {
  const Vector3d p = place - leg.hip;
  const double d = leg.thigh_offset;
  const double down = -std::sqrt(std::max(p.y() * p.y() + p.z() * p.z() - d * d, 0.0));
  const double hip = config::arc_tangent(p.z(), p.y()) - config::arc_tangent(down, d);
  const double length = std::clamp(std::sqrt(p.x() * p.x() + down * down), kShortest, kLongest);
  // Two equal links: half of the knee's angle has the cosine length / (2 link).
  const double half_cosine = length / (2.0 * kLink);
  const double half = config::arc_tangent(std::sqrt(1.0 - half_cosine * half_cosine), half_cosine);
  constexpr double kTurn = 2.0 * 3.14159265358979323846;
  const double wrapped = hip > 0.5 * kTurn ? hip - kTurn : hip < -0.5 * kTurn ? hip + kTurn : hip;
  return {wrapped, config::arc_tangent(-p.x(), -down) + half, -2.0 * half};
}

Matrix3d jacobian(const Leg& leg, const Vector3d& angles) {
  const Vector3d y = turned(angles[0], Vector3d::UnitY());
  const Vector3d shank = turned(angles[0], link(angles[1] + angles[2]));
  const Vector3d thigh = turned(angles[0], link(angles[1]));
  Matrix3d columns;
  columns.col(0) = Vector3d::UnitX().cross(foot(leg, angles) - leg.hip);
  columns.col(1) = y.cross(thigh + shank);
  columns.col(2) = y.cross(shank);
  return columns;
}

Vector3d shank_rate(const Vector3d& angles, const Vector3d& speeds) {
  return speeds[0] * Vector3d::UnitX() + (speeds[1] + speeds[2]) * turned(angles[0], Vector3d::UnitY());
}

}  // namespace visum::quadruped

// The geometry of one leg of models/quadruped: hip about x, thigh and knee about y. All in the trunk's frame:
// x forward, y left, z up, m and rad. Pure functions, with the same bits on every machine.
#pragma once

#include <Eigen/Core>
#include <array>

namespace visum::quadruped {

using Eigen::Matrix3d;
using Eigen::Vector3d;

inline constexpr int kLegs = 4;
inline constexpr double kLink = 0.2;         // thigh and shank, each
inline constexpr double kFootRadius = 0.02;  // of the ball at the end of the shank

struct Leg {
  Vector3d hip;         // the hip's axis
  double thigh_offset;  // from there to the thigh's axis along y; left is positive
};

// Front left, front right, rear left, rear right: the order of the part's joints.
inline const std::array<Leg, kLegs> kLeg = {{{{0.18, 0.07, 0}, 0.05},
                                             {{0.18, -0.07, 0}, -0.05},
                                             {{-0.18, 0.07, 0}, 0.05},
                                             {{-0.18, -0.07, 0}, -0.05}}};

// The centre of the foot's ball at the angles (hip, thigh, knee).
Vector3d foot(const Leg& leg, const Vector3d& angles);

// The angles that bring the foot to `place`, with the knee bent backwards. A place out of reach leads to the
// nearest length of the leg.
Vector3d angles_for(const Leg& leg, const Vector3d& place);

// Column i is the velocity of the foot's centre at 1 rad/s of joint i.
Matrix3d jacobian(const Leg& leg, const Vector3d& angles);

// The angular velocity of the shank against the trunk.
Vector3d shank_rate(const Vector3d& angles, const Vector3d& speeds);

}  // namespace visum::quadruped

// Forward kinematics of a chain: the tool's pose, and its motion with the joints.
#pragma once

#include <vector>

#include "clients/examples/pick_and_place/urdf_chain.h"

namespace visum::pick_and_place {

using Jacobian = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// The tool's frame in the base's.
Eigen::Isometry3d tool_pose(const Chain& chain, const Eigen::VectorXd& angles);

struct ToolMotion {
  Eigen::Isometry3d X_BT;
  Jacobian J_BT;  // rows 0..2: velocity of the tool's origin [m/rad], 3..5: angular velocity; both in B
};
ToolMotion tool_motion(const Chain& chain, const Eigen::VectorXd& angles);

// The joints' origins in B, in the order of the chain.
std::vector<Eigen::Vector3d> joint_origins(const Chain& chain, const Eigen::VectorXd& angles);

// The motion that brings `from` to `to`: translation [m], then rotation vector [rad]; both in B.
Eigen::Matrix<double, 6, 1> pose_difference(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to);

}  // namespace visum::pick_and_place

#include "clients/examples/pick_and_place/kinematics.h"

namespace visum::pick_and_place {
namespace {

Eigen::Isometry3d after_joint(const ChainJoint& joint, double angle) {
  return joint.X_PJ * Eigen::AngleAxisd(angle, joint.axis);
}

}  // namespace

Eigen::Isometry3d tool_pose(const Chain& chain, const Eigen::VectorXd& angles) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    X = X * after_joint(chain.joints[i], angles[Eigen::Index(i)]);
  }
  return X * chain.X_LT;
}

ToolMotion tool_motion(const Chain& chain, const Eigen::VectorXd& angles) {
  const auto n = Eigen::Index(chain.joints.size());
  ToolMotion motion{tool_pose(chain, angles), Jacobian(6, n)};
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  for (Eigen::Index i = 0; i < n; ++i) {
    const ChainJoint& joint = chain.joints[std::size_t(i)];
    X = X * after_joint(joint, angles[i]);
    const Eigen::Vector3d axis_B = X.linear() * joint.axis;
    motion.J_BT.col(i) << axis_B.cross(motion.X_BT.translation() - X.translation()), axis_B;
  }
  return motion;
}

std::vector<Eigen::Vector3d> joint_origins(const Chain& chain, const Eigen::VectorXd& angles) {
  std::vector<Eigen::Vector3d> origins;
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    X = X * after_joint(chain.joints[i], angles[Eigen::Index(i)]);
    origins.push_back(X.translation());
  }
  return origins;
}

Eigen::Matrix<double, 6, 1> pose_difference(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) {
  const Eigen::AngleAxisd turn(to.linear() * from.linear().transpose());
  Eigen::Matrix<double, 6, 1> difference;
  difference << to.translation() - from.translation(), turn.angle() * turn.axis();
  return difference;
}

}  // namespace visum::pick_and_place

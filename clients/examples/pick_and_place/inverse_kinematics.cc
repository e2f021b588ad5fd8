#include "clients/examples/pick_and_place/inverse_kinematics.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace visum::pick_and_place {
namespace {

constexpr int kMaxIterations = 150;
constexpr double kMaxStep_rad = 0.25;  // per iteration and joint
constexpr double kMinDamping = 1e-9;   // squared; grows with the error
constexpr double kRestGain = 0.05;     // share of the way to the rest posture per iteration
constexpr int kPatience = 12;          // iterations in which the error must shrink
constexpr double kShrinks = 0.7;       // to at most this share
constexpr int kSpreadSeeds = 24;
constexpr double kSameSolution_rad = 0.05;
constexpr double kMaxJump_rad = 0.2;  // between two points of a line

Eigen::VectorXd clamped(const Chain& chain, Eigen::VectorXd angles) {
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const ChainJoint& joint = chain.joints[i];
    double& angle = angles[Eigen::Index(i)];
    angle = std::clamp(angle, joint.lower + kLimitMargin_rad, joint.upper - kLimitMargin_rad);
  }
  return angles;
}

bool close_enough(const Eigen::Matrix<double, 6, 1>& error) {
  return error.head<3>().norm() < kPositionTolerance_m && error.tail<3>().norm() < kRotationTolerance_rad;
}

// dq = J^T (J J^T + damping I)^-1 (e - J r) + r, where r is the motion that the free joints would like.
Eigen::VectorXd step(const Jacobian& J, const Eigen::Matrix<double, 6, 1>& error,
                     const Eigen::VectorXd& wish) {
  const double damping = kMinDamping + 1e-2 * error.squaredNorm();
  const Eigen::Matrix<double, 6, 6> A = J * J.transpose() + damping * Eigen::Matrix<double, 6, 6>::Identity();
  const Eigen::Matrix<double, 6, 1> rest_of_error = error - J * wish;
  Eigen::VectorXd dq = J.transpose() * A.ldlt().solve(rest_of_error) + wish;
  const double largest = dq.cwiseAbs().maxCoeff();
  if (largest > kMaxStep_rad) dq *= kMaxStep_rad / largest;
  return dq;
}

// The i-th of n values spread evenly over [0, 1) by a van der Corput sequence in the given base.
double spread(int i, int base) {
  double value = 0.0;
  double share = 1.0;
  for (; i > 0; i /= base) {
    share /= base;
    value += share * (i % base);
  }
  return value;
}

std::vector<Eigen::VectorXd> seeds(const Chain& chain, const Eigen::Isometry3d& X_BT,
                                   const Eigen::VectorXd& rest) {
  static constexpr int kPrimes[] = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29};
  Eigen::VectorXd turned = rest;
  turned[0] = std::atan2(X_BT.translation().y(), X_BT.translation().x());
  std::vector<Eigen::VectorXd> all{rest, turned};
  for (int k = 1; k <= kSpreadSeeds; ++k) {
    Eigen::VectorXd seed = turned;
    for (std::size_t i = 0; i < chain.joints.size(); ++i) {
      const ChainJoint& joint = chain.joints[i];
      const double share = spread(k, kPrimes[i % std::size(kPrimes)]);
      // Half of the range about the middle: the seeds must reach all branches, not all postures.
      seed[Eigen::Index(i)] += 0.5 * (share - 0.5) * std::min(joint.upper - joint.lower, 6.0);
    }
    all.push_back(seed);
  }
  return all;
}

bool is_new(const std::vector<Eigen::VectorXd>& known, const Eigen::VectorXd& solution) {
  return std::none_of(known.begin(), known.end(), [&](const Eigen::VectorXd& other) {
    return (other - solution).cwiseAbs().maxCoeff() < kSameSolution_rad;
  });
}

// True if the target is too far away for any posture. The target fixes a point on the last axis (for a
// spherical wrist its middle); this checks whether that point lies beyond the length of the chain up to it.
bool is_too_far(const Chain& chain, const Eigen::Isometry3d& X_BT) {
  const ChainJoint& last = chain.joints.back();
  const Eigen::Vector3d offset =
      last.X_PJ.linear().transpose() * last.X_PJ.translation();  // in the last joint's axes
  const Eigen::Vector3d along = offset.dot(last.axis) * last.axis;
  double length = (offset - along).norm();
  for (std::size_t i = 1; i + 1 < chain.joints.size(); ++i)
    length += chain.joints[i].X_PJ.translation().norm();
  const Eigen::Vector3d point = X_BT * chain.X_LT.inverse() * Eigen::Vector3d(-along);
  return (point - chain.joints[0].X_PJ.translation()).norm() > length;
}

}  // namespace

std::optional<Eigen::VectorXd> solve_from(const Chain& chain, const Eigen::Isometry3d& X_BT,
                                          const Eigen::VectorXd& seed, const Eigen::VectorXd& rest) {
  Eigen::VectorXd angles = clamped(chain, seed);
  double checked_error = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kMaxIterations; ++i) {
    const ToolMotion motion = tool_motion(chain, angles);
    const Eigen::Matrix<double, 6, 1> error = pose_difference(motion.X_BT, X_BT);
    if (close_enough(error)) return angles;
    if (i % kPatience == 0) {
      if (error.norm() > kShrinks * checked_error) return std::nullopt;
      checked_error = error.norm();
    }
    // The pull to the rest posture fades out near the goal, so that the last steps converge quadratically.
    const double fade = std::min(1.0, 10.0 * error.norm());
    angles = clamped(chain, angles + step(motion.J_BT, error, fade * kRestGain * (rest - angles)));
  }
  return std::nullopt;
}

std::vector<Eigen::VectorXd> solve_all(const Chain& chain, const Eigen::Isometry3d& X_BT,
                                       const Eigen::VectorXd& rest, std::size_t enough) {
  std::vector<Eigen::VectorXd> solutions;
  if (is_too_far(chain, X_BT)) return solutions;
  for (const Eigen::VectorXd& seed : seeds(chain, X_BT, rest)) {
    const auto solution = solve_from(chain, X_BT, seed, rest);
    if (solution && is_new(solutions, *solution)) solutions.push_back(*solution);
    if (solutions.size() >= enough) break;
  }
  std::stable_sort(solutions.begin(), solutions.end(),
                   [&](const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
                     return (a - rest).squaredNorm() < (b - rest).squaredNorm();
                   });
  return solutions;
}

std::vector<Eigen::VectorXd> follow_line(const Chain& chain, const Eigen::VectorXd& start,
                                         const Eigen::Isometry3d& X_BT, const Eigen::VectorXd& rest,
                                         double step_m) {
  const Eigen::Isometry3d X_start = tool_pose(chain, start);
  const Eigen::Quaterniond q_start(X_start.linear());
  const Eigen::Quaterniond q_end(X_BT.linear());
  const double length = (X_BT.translation() - X_start.translation()).norm();
  const int steps = std::max(1, int(std::ceil(length / step_m)));
  std::vector<Eigen::VectorXd> line{start};
  for (int i = 1; i <= steps; ++i) {
    const double share = double(i) / steps;
    Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
    X.linear() = q_start.slerp(share, q_end).toRotationMatrix();
    X.translation() = X_start.translation() + share * (X_BT.translation() - X_start.translation());
    const auto next = solve_from(chain, X, line.back(), rest);
    if (!next || (*next - line.back()).cwiseAbs().maxCoeff() > kMaxJump_rad) return {};
    line.push_back(*next);
  }
  return line;
}

}  // namespace visum::pick_and_place

// Inverse kinematics of a redundant arm: damped least squares on the tool's six-dimensional pose. The joints
// that are left free are drawn to a rest posture and away from their limits. After Y. Nakamura, H. Hanafusa,
// "Inverse kinematic solutions with singularity robustness for robot manipulator control", 1986.
// Deterministic.
#pragma once

#include <optional>
#include <vector>

#include "clients/examples/pick_and_place/kinematics.h"

namespace visum::pick_and_place {

inline constexpr double kPositionTolerance_m = 1e-5;
inline constexpr double kRotationTolerance_rad = 1e-4;
inline constexpr double kLimitMargin_rad =
    0.05;  // kept from every limit, so that the drives have room to follow

// Searches from one seed. `rest` is the posture that the free joints are drawn to. Returns nothing if the
// tolerances are not reached within the limits.
std::optional<Eigen::VectorXd> solve_from(const Chain& chain, const Eigen::Isometry3d& X_BT,
                                          const Eigen::VectorXd& seed, const Eigen::VectorXd& rest);

// Searches from many seeds: the rest posture, turned towards the target, and a fixed spread over all joints.
// Returns the solutions that differ, the nearest to `rest` first. Stops when there are `enough`.
std::vector<Eigen::VectorXd> solve_all(const Chain& chain, const Eigen::Isometry3d& X_BT,
                                       const Eigen::VectorXd& rest, std::size_t enough = 8);

// Follows a straight line of the tool from the pose at `start` to `X_BT`, in steps of at most `step_m`. The
// turn is spread evenly over the line. Returns the joint angles on the way, `start` first; empty if the line
// cannot be followed without a jump.
std::vector<Eigen::VectorXd> follow_line(const Chain& chain, const Eigen::VectorXd& start,
                                         const Eigen::Isometry3d& X_BT, const Eigen::VectorXd& rest,
                                         double step_m = 0.005);

}  // namespace visum::pick_and_place

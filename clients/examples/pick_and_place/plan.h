// The whole job, planned before anything moves: postures at the box and at its goal, straight paths down and
// up, and paths through the air. A job that cannot be done throws Unreachable, with the reason.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "clients/examples/pick_and_place/trajectory.h"
#include "clients/examples/pick_and_place/urdf_chain.h"

namespace visum::pick_and_place {

// All values are in the frame of the arm's base [m, rad].
struct Job {
  Eigen::Vector3d from;  // the box: the middle of its foot
  Eigen::Vector3d to;
  double width = 0.04;  // of the box, both ways
  double height = 0.08;
  double yaw = 0.0;    // of the box about z
  double lift = 0.12;  // how far it is lifted
};

using Way = std::vector<JointPath>;  // legs, with a stop after each

struct Plan {
  Way to_box;          // from the start to above the box
  JointPath to_grasp;  // straight down
  JointPath lift;      // straight up
  Way carry;           // to above the goal
  JointPath put_down;  // straight down
  JointPath retreat;   // straight up
  Way home;            // back to the start
  double tilt = 0.0;   // of the gripper at both places, below the horizontal [rad]
};

class Unreachable : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

Plan make_plan(const ArmModel& arm, const Eigen::VectorXd& start, const Job& job);

}  // namespace visum::pick_and_place

// The arm as its URDF describes it: a chain of turning joints from the base to the gripper, and the gripper's
// fingers. Frames: B is the base (root link), J a joint, T the tool. T's origin is midway between the finger
// pads, its z is the palm's z, in which the gripper reaches, and its y is the direction in which the first
// finger opens.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace visum::pick_and_place {

struct ChainJoint {
  std::string name;
  Eigen::Isometry3d X_PJ;  // from the joint before it (or the base), at angle 0
  Eigen::Vector3d axis;    // unit, in J
  double lower = 0.0;      // rad; continuous joints: two turns either way
  double upper = 0.0;
  double max_speed = 0.0;  // rad/s
};

struct Chain {
  std::vector<ChainJoint> joints;
  Eigen::Isometry3d X_LT;  // from the last joint to the tool
};

// One finger on a slider; its position is the distance of its pad from the gripper's centre plane.
struct Finger {
  std::string name;                 // of the joint
  double lower = 0.0, upper = 0.0;  // m
  double max_speed = 0.0;           // m/s
};

struct ArmModel {
  Chain chain;
  std::vector<Finger> fingers;
  double tip_reach_m = 0.0;  // how far the fingers' boxes reach beyond the tool's origin, along its z
};

// Throws std::runtime_error with the file's name and the reason: unreadable, no fingers, fingers on different
// links, or a joint in the chain that neither turns nor is fixed.
ArmModel read_arm(const std::string& urdf_file);

}  // namespace visum::pick_and_place

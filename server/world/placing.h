// Puts bodies and joints somewhere else between ticks, and moves kinematic bodies along within a tick. Pure
// functions over plain values.
//
// A body takes along all that hangs on it by joints that carry (joint_tree.h): these keep their places and
// motions as seen from it. A joint that is set takes along all that hangs on its child.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "server/world/world_state.h"

namespace visum::world {

// Where a body's link frame is, and how it moves.
struct Placement {
  Pose X_WB;
  Eigen::Vector3d v_WB = Eigen::Vector3d::Zero();  // of B's origin, in W
  Eigen::Vector3d w_WB = Eigen::Vector3d::Zero();  // in W
};
Placement placement_of(const Body& body, const BodyState& state);

struct JointPlacement {
  JointId joint;
  double position = 0.0;  // rad or m
  double velocity = 0.0;
};

// Why the body cannot be put elsewhere: it is fixed, or something beside the bodies that hang on it holds it.
// Empty: it can.
std::string placing_fault(const WorldModel& model, BodyId body);
// Why the joint cannot be set: it has no coordinate, it closes a loop or is part of one, or the values are
// not finite or beyond its stops. Empty: it can.
std::string placing_fault(const WorldModel& model, const JointPlacement& to);

// For what has no fault. The joints' positions and velocities are measured anew.
void place_body(const WorldModel& model, BodyId body, const Placement& to, WorldState& state);
void place_joints(const WorldModel& model, std::span<const JointPlacement> to, WorldState& state);

// The kinematic bodies of a world in the order in which they move: those that hang on no joint, then those
// that do, parents first.
struct KinematicTree {
  std::vector<BodyId> roots;
  std::vector<JointId> joints;
};
KinematicTree kinematic_tree(const WorldModel& model);

// Moves kinematic bodies by one tick: roots with their velocities, the others as the velocities of their
// joints say. A joint stops at its stops. One without a coordinate carries its child along. `before` is the
// state at the tick's begin. Allocates nothing.
void move_kinematic(const WorldModel& model, const KinematicTree& tree, double tick_s,
                    const WorldState& before, WorldState& state);

}  // namespace visum::world

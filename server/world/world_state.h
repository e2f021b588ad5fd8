// The changing half of a world: flat, copyable, hashable. This is the only truth: an engine reads it before a
// step and writes it after; restoring is assigning. Lives on the tick's thread; others get copies.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/world/world_model.h"

namespace visum::world {

// One body's motion, of its centre of mass. q is kept exactly as the engine left it: never renormalised on
// the way.
struct BodyState {
  Eigen::Vector3d p_WC;     // m
  Eigen::Quaterniond q_WB;  // unit
  Eigen::Vector3d v_WC;     // m/s
  Eigen::Vector3d w_WB;     // rad/s, in W
};

// Of a joint with one coordinate (joint_kinds.h); else all zero.
struct JointState {
  double position = 0.0;  // rad or m, unwrapped; along a curve: its parameter
  double velocity = 0.0;
  double effort = 0.0;  // what the joint's drive transmitted in the last tick (hwparts/joint.h)
};

struct WorldState {
  std::int64_t tick = 0;
  std::vector<BodyState> bodies;      // by BodyId, fixed ones too
  std::vector<JointState> joints;     // by JointId; derived from bodies, except that position counts turns
  std::vector<std::uint64_t> random;  // one generator per world: its words
  std::vector<std::vector<std::byte>>
      engines;  // what an engine needs beyond bodies (seeds, warm starts), by engine
};

// The scene's initial state. Applies each joint's initial position by moving the subtree below it.
WorldState initial_state(const WorldModel& model);

Pose link_pose(const Body& body, const BodyState& state);                 // X_WB
Eigen::Vector3d link_velocity(const Body& body, const BodyState& state);  // of B's origin, in W

// Joint positions and velocities from the bodies'; angles go on from the previous ones across turns, also
// those of which more than half is turned in the time since, `elapsed_s`.
void measure_joints(const WorldModel& model, WorldState& state, double elapsed_s = 0.0);

// True if all is finite and within 1e6 m, m/s, rad/s. Names the first offender otherwise.
bool is_sane(const WorldModel& model, const WorldState& state, std::string* offender);

// Appends every field, in order, without padding; state_hash is XXH64 over those bytes.
void save(const WorldState& state, std::vector<std::byte>& bytes);
// The way back, for a state of this very model; returns what follows it. Where the bytes are none, or a
// number in them is not sane, `fault` (empty before) tells so and `state` stays as it is.
std::span<const std::byte> load(std::span<const std::byte> bytes, const WorldModel& model, WorldState& state,
                                std::string& fault);
std::uint64_t hash_bytes(std::span<const std::byte> bytes);

}  // namespace visum::world

// The changing half of a world: flat, copyable, hashable. It is the only truth: an engine reads it before a
// step and writes it after the step, so that restoring is an assignment. Lives on the tick's thread; other
// threads get copies.
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

// The motion of one body, at its centre of mass. The quaternion stays exactly as the engine left it: it is
// never renormalised by saving, loading or publishing.
struct BodyState {
  Eigen::Vector3d p_WC;     // m
  Eigen::Quaterniond q_WB;  // unit
  Eigen::Vector3d v_WC;     // m/s
  Eigen::Vector3d w_WB;     // rad/s, in W
};

// The state of a joint with one coordinate (joint_kinds.h). All zero for the other kinds.
struct JointState {
  double position = 0.0;  // rad or m, unwrapped; along a curve: its parameter
  double velocity = 0.0;
  double effort = 0.0;  // what the joint's drive transmitted in the last tick (hwparts/joint.h)
};

struct WorldState {
  std::int64_t tick = 0;
  std::vector<BodyState> bodies;      // by BodyId, fixed ones too
  std::vector<JointState> joints;     // by JointId; derived from bodies, except that position counts turns
  std::vector<std::uint64_t> random;  // the words of the world's one random generator
  // By engine: what it needs to go on beside bodies and joints (seeds, warm starts).
  std::vector<std::vector<std::byte>> engines;
  // The impulses between bodies of two engines in the last tick (dynamics/coupling.h).
  std::vector<std::byte> coupling;
};

// The initial state of a scene. Each joint's initial position moves the whole subtree below the joint.
WorldState initial_state(const WorldModel& model);

Pose link_pose(const Body& body, const BodyState& state);                 // X_WB
Eigen::Vector3d link_velocity(const Body& body, const BodyState& state);  // of B's origin, in W

// Derives positions and velocities of the joints from the bodies. Angles count turns: they go on from the
// previous ones, also where a joint turns by more than half a turn within `elapsed_s`, the time since then.
void measure_joints(const WorldModel& model, WorldState& state, double elapsed_s = 0.0);

// True if all numbers are finite, quaternions are of unit length, and bodies are within 1e6 m, m/s and rad/s.
// Otherwise `offender` (may be null) gets a text that names the first body or joint.
bool is_sane(const WorldModel& model, const WorldState& state, std::string* offender);

// Appends every field in order, without padding. A world's state hash is XXH64 over these bytes and those
// that cycle::Simulation appends.
void save(const WorldState& state, std::vector<std::byte>& bytes);
// Reads a state of this very model and returns the bytes that follow it. `fault` must be empty before. Where
// the bytes are no such state, or a number in them is not sane, it says so and `state` stays as it is.
std::span<const std::byte> load(std::span<const std::byte> bytes, const WorldModel& model, WorldState& state,
                                std::string& fault);
// XXH64 with seed 0.
std::uint64_t hash_bytes(std::span<const std::byte> bytes);

}  // namespace visum::world

#include "server/cycle/follow.h"

#include <algorithm>

namespace visum::cycle {
namespace {

constexpr double kGapPerTick = 0.5;
constexpr double kMostSpeed = 1e3;   // rad/s or m/s, where the model gives none
constexpr double kMostEffort = 1e4;  // N·m or N, where the model gives none

}  // namespace

hwparts::JointDrive follow(const scene::FollowerPlan& follower, const world::WorldState& state,
                           double tick_s) {
  const world::JointState& leader = state.joints[follower.leader.index()];
  const world::JointState& joint = state.joints[follower.joint.index()];
  const double gap = follower.multiplier * leader.position + follower.offset - joint.position;
  const double speed = follower.multiplier * leader.velocity + kGapPerTick * gap / tick_s;
  const double most = follower.maximum_speed > 0.0 ? follower.maximum_speed : kMostSpeed;
  return {std::clamp(speed, -most, most), 0.0,
          follower.maximum_effort > 0.0 ? follower.maximum_effort : kMostEffort, 0.0};
}

}  // namespace visum::cycle

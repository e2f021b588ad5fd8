#include "server/scene/robot_loops.h"

#include <algorithm>
#include <set>

#include "protocol/config/number_text.h"

namespace visum::scene {
namespace {

// True if the joint's links hang together without it.
bool is_in_loop(const RobotModel& model, const RobotJoint& joint) {
  std::set<std::string> reached{joint.parent};
  for (bool grows = true; grows;) {
    grows = false;
    for (const RobotJoint& other : model.joints) {
      if (&other == &joint || reached.contains(other.parent) == reached.contains(other.child)) continue;
      reached.insert({other.parent, other.child});
      grows = true;
    }
  }
  return reached.contains(joint.child);
}

}  // namespace

void keep_loop_closed(RobotModel& model, const RobotJoint& from, world::Joint& joint) {
  const bool moved = joint.limited && joint.initial_position != from.initial && !from.mimic;
  if (!moved || !is_in_loop(model, from)) return;
  model.losses.push_back({"joint '" + from.joint.name + "' begins at " + config::number_text(from.initial) +
                              ", outside its limits " + config::number_text(joint.lower) + " and " +
                              config::number_text(joint.upper) +
                              "; it closes a loop, so it stays there, and the nearer limit with it",
                          from.line, from.file});
  joint.lower = std::min(joint.lower, from.initial);
  joint.upper = std::max(joint.upper, from.initial);
  joint.initial_position = from.initial;
}

}  // namespace visum::scene

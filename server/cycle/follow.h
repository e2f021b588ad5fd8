// The servo of a joint that follows another one (a URDF's <mimic>): q_f = multiplier * q + offset.
//
// The engines couple no two joints, so this is a drive like others. It holds the joint at its place against
// any load up to the joint's effort limit, but the joint that it follows does not feel that load. To hand the
// load on one tick late would be unstable where the follower is the heavier one.
#pragma once

#include "hwparts/joint.h"
#include "server/scene/scene.h"
#include "server/world/world_state.h"

namespace visum::cycle {

// The drive of the next tick. The target velocity is the other joint's, and half of the gap within the tick:
// the faster law, the whole gap, still rings (its poles have the size 0.7, those of half a gap 0.5).
hwparts::JointDrive follow(const scene::FollowerPlan& follower, const world::WorldState& state,
                           double tick_s);

}  // namespace visum::cycle

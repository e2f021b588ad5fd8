// Pairs of bodies that never collide, as an encoding must tell them.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "server/world/world_model.h"

namespace visum::scene {

// Of `no_collision`, those that are not between the two bodies of a joint for which `keeps_apart` holds, in
// their order: what the joints of a file say is not to be told again.
std::vector<std::pair<world::BodyId, world::BodyId>> pairs_beside_joints(
    const world::WorldModel& world, const std::function<bool(const world::Joint&)>& keeps_apart);

}  // namespace visum::scene

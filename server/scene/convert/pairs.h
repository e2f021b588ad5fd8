// Selects the pairs of bodies that an encoding must list because they never collide.
#pragma once

#include <functional>
#include <utility>
#include <vector>

#include "server/world/world_model.h"

namespace visum::scene {

// The pairs of `no_collision`, in their order, without those between two bodies of a joint for which
// `keeps_apart` is true: the joints of the file already say that.
std::vector<std::pair<world::BodyId, world::BodyId>> pairs_beside_joints(
    const world::WorldModel& world, const std::function<bool(const world::Joint&)>& keeps_apart);

}  // namespace visum::scene

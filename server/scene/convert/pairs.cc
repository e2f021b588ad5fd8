#include "server/scene/convert/pairs.h"

#include <algorithm>
#include <iterator>

namespace visum::scene {

std::vector<std::pair<world::BodyId, world::BodyId>> pairs_beside_joints(
    const world::WorldModel& world, const std::function<bool(const world::Joint&)>& keeps_apart) {
  std::vector<std::pair<world::BodyId, world::BodyId>> joined, pairs;
  for (const world::Joint& joint : world.joints)
    if (joint.parent.valid() && keeps_apart(joint)) joined.push_back(std::minmax(joint.parent, joint.child));
  std::ranges::sort(joined);
  std::ranges::set_difference(world.no_collision, joined, std::back_inserter(pairs));
  return pairs;
}

}  // namespace visum::scene

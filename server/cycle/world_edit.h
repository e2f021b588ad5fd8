// Taking a body out of a model, with everything that counts by its number.
#pragma once

#include <string>

#include "server/world/world_model.h"

namespace visum::cycle {

// Why the body has to stay (it belongs to a model, a joint holds it); empty: it may go.
std::string why_not_removable(const world::WorldModel& model, world::BodyId body);

// Removes the body, its shapes, and the meshes that nothing else uses; the ids of the bodies behind it move
// down by one.
void erase_body(world::WorldModel& model, world::BodyId body);

}  // namespace visum::cycle

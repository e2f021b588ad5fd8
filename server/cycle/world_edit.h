// Takes bodies and models out of a world and renumbers everything that refers to them by ids. Pure functions.
#pragma once

#include <string>

#include "server/cycle/outcome.h"
#include "server/scene/scene.h"
#include "server/world/world_model.h"

namespace visum::cycle {

// Refuses a name that no body has, and names the nearest.
Outcome unknown_body(const world::WorldModel& model, const std::string& name);

// Refuses where the body belongs to a model or a joint holds it.
Outcome can_remove(const world::WorldModel& model, world::BodyId body);

// Removes the body, its shapes, and the meshes that nothing else uses. The ids of the bodies behind it move
// down by one. The body must be removable.
void erase_body(world::WorldModel& model, world::BodyId body);

// Removes a model of scene.spawned, with all that it brought, and renumbers the rest. Surfaces and materials
// stay.
void erase_spawned(scene::Scene& scene, const scene::Spawned& model);

}  // namespace visum::cycle

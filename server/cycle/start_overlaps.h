// Bodies that overlap where a world starts: an engine would drive them apart in the first ticks, or work on
// them in vain. `visum check` reports them, and models may have them left out.
#pragma once

#include <vector>

#include "server/scene/scene.h"
#include "server/world/ids.h"
#include "server/world/world_model.h"

namespace visum::collision {
class PreparedMeshes;
}

namespace visum::cycle {

struct Overlap {
  world::BodyId a, b;    // a < b
  double depth_m = 0.0;  // of the deepest contact
};

inline constexpr double kLeastOverlap = 1e-6;  // m; less is touching

// Returns the pairs of bodies that may collide and overlap at tick 0, as the collision stage finds them: the
// deepest first, then by number. The work is that of one tick, with its limits. Throws std::runtime_error for
// shapes that the stage refuses.
std::vector<Overlap> overlaps_at_start(const world::WorldModel& model, collision::PreparedMeshes& meshes);

// Adds to `no_collision` the pairs that overlap at the start within each model whose entry asks for it, and
// reports them as repairs. The scene alone decides, so a replay leaves out the same pairs.
scene::Scene leave_out_overlaps(scene::Scene scene, collision::PreparedMeshes& meshes);

}  // namespace visum::cycle

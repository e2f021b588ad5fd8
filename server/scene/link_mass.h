// The mass of a link that moves, where its file gives none or one that no solid has. Pure function.
#pragma once

#include <string>
#include <vector>

#include "server/scene/inertia.h"
#include "server/world/world_model.h"

namespace visum::scene {

struct RepairedMass {
  MassProperties mass;
  std::string repair;  // what was done, as a clause about the link; empty: nothing
};

// `given` may have no mass or no proper inertia. Then the shapes say how mass is spread (those that collide;
// without any, those that are seen), and `density` [kg/m³] how much there is. Of a mesh that is not closed,
// the box around it counts. A link without any volume becomes a ball of 5 cm radius.
RepairedMass repaired_mass(const MassProperties& given, const std::vector<world::Shape>& shapes,
                           const std::vector<world::TriangleMesh>& meshes, double density);

}  // namespace visum::scene

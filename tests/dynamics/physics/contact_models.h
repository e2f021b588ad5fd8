// Worlds with contacts that the physics suite and the benchmarks share.
#pragma once

#include "server/world/world_model.h"

namespace visum::physics {

// Bodies that are to touch overlap by this much, m. A gap of 0 is no contact in the first tick; the bodies
// would fall by g h² / 2 before there is one.
inline constexpr double kTouch = 1e-6;

// `count` cubes of 0.2 m and 1 kg, one on another, on the plane z = 0, with friction 0.5. The topmost one
// weighs `top_mass_kg`.
world::WorldModel stack(const world::EngineSetting& engine, double tick_s, int count,
                        double top_mass_kg = 1.0);

}  // namespace visum::physics

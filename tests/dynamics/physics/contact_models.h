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

// `count` such stacks of `height` cubes side by side, 1 m apart, in a square.
world::WorldModel towers(const world::EngineSetting& engine, double tick_s, int count, int height);

// `side` rows of `side` bricks of 0.4 x 0.2 x 0.2 m and 1 kg. Every other row is shifted by half a brick, and
// begins and ends with half a brick of 0.5 kg, so each brick rests on two: the wall stands.
world::WorldModel standing_wall(const world::EngineSetting& engine, double tick_s, int side);

// The same rows of whole bricks alone, 1 mm apart. The last bricks of shifted rows hang half over the end;
// they tip within half a second, and the rows above them follow.
world::WorldModel falling_wall(const world::EngineSetting& engine, double tick_s, int side);

// `count` heaps, `pitch` m apart in a row, each of `boxes` cubes of 0.2 m and 1 kg. The cubes hang in layers
// over each other, each shifted and turned a little in its own way, then fall.
world::WorldModel piles(const world::EngineSetting& engine, double tick_s, int count, int boxes,
                        double pitch = 5.0);

}  // namespace visum::physics

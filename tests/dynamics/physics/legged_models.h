// Robots with legs, and a figure with limbs, that the physics suite and the benchmarks share.
#pragma once

#include <string>

#include "server/world/world_model.h"
#include "tests/dynamics/model_builder.h"

namespace visum::physics {

// A robot with four legs and twelve hinges, of 20 kg, that stands on the plane z = 0 with its trunk over
// (x, y). Nothing drives its joints. All names begin with `prefix`.
void add_quadruped(dynamics::testing::ModelBuilder& builder, const std::string& prefix, double x, double y);

// How the joints of standing quadrupeds are held: by dry friction, or by springs with dampers beside them.
enum class Held { kByFriction, kBySprings };
// `count` of them in rows of ten, 2 m apart, on a plane.
world::WorldModel standing_quadrupeds(const world::EngineSetting& engine, double tick_s, int count,
                                      Held held);

// `count` tables of 14 kg whose four legs are parallelograms of hinges, with a ball as a foot, in rows of
// ten, 2 m apart, on a plane. Dry friction in one hinge holds each leg.
world::WorldModel standing_linkages(const world::EngineSetting& engine, double tick_s, int count);

// `count` figures of eleven parts with ball joints and hinges, which fall onto a plane from 0.5 m, each
// turned in another way. In rows of ten, 3 m apart. `first`: number of the first one.
world::WorldModel falling_ragdolls(const world::EngineSetting& engine, double tick_s, int count,
                                   int first = 0);

}  // namespace visum::physics

// Mechanisms with closed loops, from the library of benchmarks of multibody dynamics of IFToMM (A02, A04).
#pragma once

#include "server/world/world_model.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::physics {

// IFToMM A02: n four-bars side by side in the plane x, z: n + 1 upright rods of 1 m and 1 kg on the ground,
// their tops joined by n more; the first top, B0, moves at 1 m/s along x. One degree of freedom:
// ((n+1)/3 + n) θ'' = ((n+1)/2 + n) g sin θ, with θ from upright. Each hinge but one per loop is needed; in
// space 2n of the rows are redundant, and once a turn the mechanism is singular.
world::WorldModel four_bars(const world::EngineSetting& engine, double tick_s, int loops);
inline const Eigen::Vector3d kFourBarsB0{0.0, 0.0, 1.0};  // in "rod_0"
const std::vector<TipAt>& four_bars_tips();               // of B0, for two loops

// IFToMM A04: Bricard's mechanism: five rods of 1 m and 1 kg, 0.1 m square, six hinges whose axes are
// perpendicular in turn. By count it cannot move; it can.
world::WorldModel bricard(const world::EngineSetting& engine, double tick_s);

}  // namespace visum::physics

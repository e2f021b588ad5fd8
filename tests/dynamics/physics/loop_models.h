// Mechanisms with closed loops, from IFToMM's library of benchmarks for multibody dynamics (A02, A04, A05).
#pragma once

#include "server/world/world_model.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::physics {

// IFToMM A02: n four-bars side by side in the plane x, z. n + 1 upright rods of 1 m and 1 kg stand on the
// ground, and n more join their tops. The first top, B0, moves at 1 m/s along x. One degree of freedom:
// ((n+1)/3 + n) θ'' = ((n+1)/2 + n) g sin θ, with θ from upright. All hinges but one per loop are needed. In
// space 2n of the rows are redundant, and once a turn the mechanism is singular.
world::WorldModel four_bars(const world::EngineSetting& engine, double tick_s, int loops);
inline const Eigen::Vector3d kFourBarsB0{0.0, 0.0, 1.0};  // in "rod_0"
const std::vector<TipAt>& four_bars_tips();               // of B0, for two loops
Eigen::Vector3d four_bars_tip(int loops, double time_s);  // of B0, integrated

// IFToMM A04: Bricard's mechanism, five rods of 1 m and 1 kg, 0.1 m square, with six hinges, each axis
// perpendicular to the next. By counting it cannot move, but it can.
world::WorldModel bricard(const world::EngineSetting& engine, double tick_s);

// IFToMM A05: the flyball governor, turning at 2π rad/s. Two rods of 1 m, 0.01 m square, with balls of 5 kg
// at their ends, are hinged to a shaft's upper end, 30° off it. A cube of 0.1 m slides on the shaft. Couplers
// hold it at the rods' middles; they are stiff springs with dampers (8e5 N/m, 4e4 N s/m, 0.5 m), 5e4 times
// faster than the governor swings. Shaft, rods and cube have 3000 kg/m³. With a the rods' angle, z the cube's
// way down, l the couplers' length, F = K (l - 0.5 m) + C l' their pull and I(a) the inertia about the shaft:
//   I φ' constant,  2 J a'' = I'(a) φ'²/2 - dV/da - 2 F dl/da,  m z'' = m g - 2 F dl/dz
world::WorldModel governor(const world::EngineSetting& engine, double tick_s);
struct GovernorAt {
  double time_s;
  double angle;    // a, rad; both rods start at π/6, where the joint "left_hinge" is at 0
  double slide_m;  // z
};
const std::vector<GovernorAt>& governor_poses();

}  // namespace visum::physics

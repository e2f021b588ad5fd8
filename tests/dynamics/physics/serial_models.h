// Open chains of hinges, with the data and reference values that the physics suite and the benchmarks share.
// References: integrated by Gragg, Bulirsch and Stoer's method in long double; two step sizes agree to 1e-11.
#pragma once

#include <vector>

#include "server/world/world_model.h"

namespace visum::physics {

struct Link {
  Eigen::Vector3d p_joint;  // of its joint, in the link before; for the first link in W
  Eigen::Vector3d axis;
  double mass_kg;
  Eigen::Vector3d p_com;    // from its joint
  Eigen::Vector3d inertia;  // principal, about the centre of mass
  double q0;                // initial angle
};

// Bodies "link_0".., joints "joint_0"..; at rest, no shapes.
world::WorldModel serial_model(const world::EngineSetting& engine, double tick_s,
                               const std::vector<Link>& links);

Eigen::Vector3d solid_cylinder_inertia(double mass_kg, double radius, double length);  // its axis is z

// Seven hinges z, y, z, y, z, y, z. Swinging free from its start it is hard: the wrist spins at more than 10
// rad/s.
world::WorldModel arm7(const world::EngineSetting& engine, double tick_s);
inline const Eigen::Vector3d kArm7Tip{0.0, 0.0, 0.3};  // in the last link
struct TipAt {
  double time_s;
  Eigen::Vector3d p_W;
};
const std::vector<TipAt>& arm7_tips();

// n hanging rods of 0.1 m, axes y and x in turn, the first deflected by 0.5 rad.
world::WorldModel chain(const world::EngineSetting& engine, double tick_s, int links);
inline const Eigen::Vector3d kChainTip{0.0, 0.0, -0.1};

// Two rods of 1 m and 1 kg about y, both level at rest.
world::WorldModel double_pendulum(const world::EngineSetting& engine, double tick_s);
inline const Eigen::Vector3d kDoublePendulumTip{0.0, 0.0, -1.0};
const std::vector<TipAt>& double_pendulum_tips();  // y is 0

// A pendulum that swings as a point on a rod of 1 m does: 1 kg, d = 0.5 m from the axis, inertia m d (1 m -
// d). It starts at rest, `angle` off its lowest place. (A point without inertia of its own would not test the
// physics.)
world::WorldModel metre_pendulum(const world::EngineSetting& engine, double tick_s, double angle);
// A thin rod of 1 m and 1 kg about its end.
world::WorldModel rod_pendulum(const world::EngineSetting& engine, double tick_s, double angle);

}  // namespace visum::physics

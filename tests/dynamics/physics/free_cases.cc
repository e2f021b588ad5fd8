// F: bodies that nothing holds.
#include <algorithm>
#include <cmath>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/free_models.h"
#include "tests/dynamics/physics/measures.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::physics {
namespace {

using Eigen::Vector3d;

std::vector<double> simple_toss(const world::EngineSetting& engine) {
  const Toss result = toss(tossed_box(engine, 1e-3, {-0.9, 0.4, 0.1}, {0.5, 0.0, 0.0}, 0.0)).front();
  return {result.momentum, result.energy, result.com_m};
}

std::vector<double> tumble(const world::EngineSetting& engine) {
  const Toss result = toss(tumbling_box(engine, 1e-3)).front();
  return {result.momentum, result.energy, result.com_m, angle_between(tumbled(), result.R)};
}

std::vector<double> tumble_coarsely(const world::EngineSetting& engine) {
  const Toss result = toss(tumbling_box(engine, 1e-2)).front();
  return {result.momentum, result.com_m};
}

// Seven links in space, straight, each joint turning at a rate of its own.
world::WorldModel floating_chain(const world::EngineSetting& engine) {
  constexpr double kRates[] = {0.0, 0.7, -1.1, 0.4, 1.3, -0.6, 0.9};
  auto model = arm7(engine, 1e-3);
  model.gravity.setZero();
  model.bodies[0].v_WB = {0.1, -0.2, 0.3};
  model.bodies[0].w_WB = {0.3, 0.2, -0.1};
  for (std::size_t i = 1; i < model.bodies.size(); ++i) {
    const auto& joint = model.joints[i];
    const auto& before = model.bodies[i - 1];
    model.bodies[i].v_WB = before.v_WB + before.w_WB.cross(joint.X_PJ.p);
    model.bodies[i].w_WB = before.w_WB + kRates[i] * joint.axis_J;
  }
  for (auto& joint : model.joints) joint.initial_position = 0.0;
  model.joints.erase(model.joints.begin());
  return model;
}

std::vector<double> keep_momentum(const world::EngineSetting& engine) {
  Lab lab(floating_chain(engine));
  MomentumDrift drift(lab.model, lab.state);
  watch(lab, 2.0, [&] { drift.look(lab.model, lab.state); });
  return {drift.linear, drift.angular};
}

}  // namespace

std::vector<Case> free_cases() {
  return {
      {"F1",
       "FreeBoxSlidesAndSpins",
       "closed form: x = v t, L and E constant",
       {{"momentum", 1e-13}, {"energy", 1e-12}, {"com_m", 1e-11}},
       simple_toss},
      {"F2",
       "FreeBoxTumbles",
       "closed form: parabola, L and E constant; orientation after 10 s by DOP853 at 1e-12 (scpeters' "
       "complex box)",
       {{"momentum", 1e-13}, {"energy", 1e-5}, {"com_m", 1e-9}, {"orientation_rad", 1e-3}},
       tumble},
      {"F2c",
       "FreeBoxTumblesIn10msSteps",
       "closed form: parabola, L constant",
       {{"momentum", 1e-13}, {"com_m", 1e-9}},
       tumble_coarsely},
      {"F3",
       "FloatingChainKeepsItsMomentum",
       "closed form: P and L constant",
       {{"momentum", 1e-12}, {"angular_momentum", 1e-12}},
       keep_momentum},
  };
}

}  // namespace visum::physics

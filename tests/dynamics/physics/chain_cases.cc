// C: long chains, heavy tips, trees.
#include <algorithm>
#include <cmath>
#include <string>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/measures.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::physics {
namespace {

struct Held {
  double gap_m = 0.0;
  double energy = 0.0;  // relative to energy_scale
};

Held hold(world::WorldModel model, double seconds) {
  Lab lab(std::move(model));
  const double energy = energy_of(lab.model, lab.state), scale = energy_scale(lab.model);
  Held held;
  watch(lab, seconds, [&] {
    held.gap_m = std::max(held.gap_m, max_gap(lab.model, lab.state));
    held.energy = std::max(held.energy, std::abs(energy_of(lab.model, lab.state) - energy) / scale);
  });
  return held;
}

std::vector<double> hold_chains(const world::EngineSetting& engine) {
  const Held eight = hold(chain(engine, 1e-3, 8), 1.0), many = hold(chain(engine, 1e-3, 64), 0.05);
  return {eight.gap_m, eight.energy, many.gap_m, many.energy};
}

std::vector<double> hold_long_chain(const world::EngineSetting& engine) {
  const Held held = hold(chain(engine, 1e-3, 512), 0.1);
  return {held.gap_m, held.energy};
}

std::vector<double> hold_heavy_tip(const world::EngineSetting& engine, double ratio) {
  auto model = chain(engine, 1e-3, 8);
  auto& tip = model.bodies.back();
  tip.mass_kg *= ratio;
  tip.inertia_C *= ratio;
  const Held held = hold(std::move(model), 1.0);
  return {held.gap_m, held.energy};
}

std::vector<double> hold_hundredfold(const world::EngineSetting& engine) {
  return hold_heavy_tip(engine, 100.0);
}

std::vector<double> hold_thousandfold(const world::EngineSetting& engine) {
  return hold_heavy_tip(engine, 1000.0);
}

// A mobile: every bar hangs by a ball joint in its middle from an end of the bar above; 1 + 2 + 4 + ... bars.
world::WorldModel mobile(const world::EngineSetting& engine, int bars) {
  constexpr double kDrop = 0.2;
  auto model = serial_model(engine, 1e-3, {});
  for (int i = 0; i < bars; ++i) {
    const int parent = (i - 1) / 2, level = static_cast<int>(std::log2(i + 1));
    const double reach = 0.5 * std::pow(0.7, level);
    world::Body body;
    body.name = "bar_" + std::to_string(i);
    body.mass_kg = 0.5;
    body.p_BC = {0.0, 0.0, -kDrop};
    body.inertia_C = Eigen::Vector3d(1e-3, 0.04 * reach, 0.04 * reach).asDiagonal();
    world::Joint joint;
    joint.name = "ball_" + std::to_string(i);
    joint.kind = world::JointKind::kBall;
    joint.child = {i};
    if (i > 0) {
      joint.parent = {parent};
      joint.X_PJ.p = {(i % 2 == 1 ? -1.0 : 1.0) * reach / 0.7, 0.0, -kDrop};
      body.X_WB.p = model.bodies[static_cast<std::size_t>(parent)].X_WB.p + joint.X_PJ.p;
    }
    model.bodies.push_back(body);
    model.joints.push_back(joint);
  }
  // One arm is loaded, so that all of it moves.
  model.bodies.back().mass_kg *= 4.0;
  return model;
}

std::vector<double> hold_tree(const world::EngineSetting& engine) {
  const Held held = hold(mobile(engine, 127), 0.1);
  return {held.gap_m, held.energy};
}

std::vector<double> hold_wide_tree(const world::EngineSetting& engine) {
  const Held held = hold(mobile(engine, 255), 0.05);
  return {held.gap_m, held.energy};
}

}  // namespace

std::vector<Case> chain_cases() {
  return {
      {"C1",
       "ChainsOf8And64Hold",
       "closed form: gap 0, E constant",
       {gap_figure("gap_8_m"), {"energy_8", 1e-4}, gap_figure("gap_64_m"), {"energy_64", 1e-4}},
       hold_chains},
      {"C1l",
       "ChainOf512Holds",
       "closed form: gap 0, E constant",
       {gap_figure("gap_m"), {"energy", 1e-4}},
       hold_long_chain,
       true},
      {"C2",
       "TipOf100TimesTheMassHolds",
       "closed form: gap 0, E constant",
       {gap_figure("gap_m"), {"energy", 1e-3}},
       hold_hundredfold},
      {"C2k",
       "TipOf1000TimesTheMassHolds",
       "closed form: gap 0, E constant",
       {gap_figure("gap_m"), {"energy", 1e-3}},
       hold_thousandfold},
      {"C3",
       "MobileOf127BarsHolds",
       "closed form: gap 0, E constant (the mobiles of Bender and Deul)",
       {gap_figure("gap_m"), {"energy", 1e-4}},
       hold_tree},
      {"C3w",
       "MobileOf255BarsHolds",
       "closed form: gap 0, E constant (the mobiles of Bender and Deul)",
       {{"gap_m", 1e-5}, {"energy", 1e-4}},
       hold_wide_tree},
  };
}

}  // namespace visum::physics

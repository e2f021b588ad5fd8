// A: a mechanism that is stopped after any number of corrections stays together, only loses energy, and
// warns.
#include <algorithm>
#include <cmath>

#include "tests/dynamics/physics/case.h"
#include "tests/dynamics/physics/measures.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::physics {
namespace {

struct Stopped {
  double gap_m = 0.0;
  double gain = 0.0;  // of energy, relative to energy_scale
};

Stopped stop_after(world::EngineSetting engine, int budget) {
  engine.budget = budget;
  Lab lab(chain(engine, 1e-3, 8));
  const double energy = energy_of(lab.model, lab.state), scale = energy_scale(lab.model);
  Stopped result;
  watch(lab, 0.5, [&] {
    result.gap_m = std::max(result.gap_m, max_gap(lab.model, lab.state));
    result.gain = std::max(result.gain, (energy_of(lab.model, lab.state) - energy) / scale);
  });
  return result;
}

std::vector<double> stop_anywhere(const world::EngineSetting& engine) {
  double gain = 0.0, widening = 0.0, before = 1e9, gap = 0.0;
  for (const int budget : {1, 2, 4, 8, 16, 32, 64, 128}) {
    const Stopped stopped = stop_after(engine, budget);
    gain = std::max(gain, stopped.gain);
    widening = std::max(widening, stopped.gap_m - before);
    before = stopped.gap_m;
    gap = std::max(gap, stopped.gap_m);
  }
  return {gap, std::max(0.0, widening), gain};
}

// Counts ticks with a gap and no warning, and warnings where the budget was large enough. The norm of a gap
// is up to sqrt(3) times its largest coordinate, which d_max bounds.
std::vector<double> tell(const world::EngineSetting& engine) {
  constexpr double kDMax = 1e-8;
  constexpr int kPlenty = 100'000;
  double untold = 0.0, needless = 0.0;
  const std::vector<int> budgets =
      engine.solver == "iterate" ? std::vector{1, 4, 16, 64, kPlenty} : std::vector{kPlenty};
  for (const int budget : budgets) {
    world::EngineSetting setting = engine;
    setting.d_max = kDMax;
    setting.v_max = kDMax;
    setting.budget = budget;
    Lab lab(chain(setting, 1e-3, 8));
    int warned = 0;
    watch(lab, 0.2, [&] {
      const bool told = lab.warned_ticks > warned;
      warned = lab.warned_ticks;
      if (!told && max_gap(lab.model, lab.state) > 2.0 * kDMax) ++untold;
      if (told && budget == kPlenty) ++needless;
    });
  }
  return {untold, needless};
}

}  // namespace

std::vector<Case> anytime_cases() {
  return {
      {"A1",
       "FewerCorrectionsOnlyDamp",
       "closed form: E does not grow, and the gap does not grow with the corrections (1 to 128 per joint)",
       {{"gap_m", 0.1}, {"widening_m", 1e-6}, {"energy_gain", 1e-4}},
       stop_anywhere},
      {"A2",
       "WhatItsBudgetLeavesIsTold",
       "a tick whose joints are farther apart than d_max gets a warning, a tick with budget enough gets "
       "none",
       {{"untold_ticks", 0.0}, {"needless_warnings", 0.0}},
       tell}};
}

}  // namespace visum::physics

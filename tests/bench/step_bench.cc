// The cost of a step, side by side: Step/<model>/<engine>, ticks of 1 ms, starting from the same state after
// each batch. Counters say how good the step is: tip_error_m (where there is a reference), energy_error
// (relative to energy_scale; not for contacts) and gap_m, each the largest over the batch.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/bench/stepper_kinds.h"
#include "tests/dynamics/physics/contact_models.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/loop_models.h"
#include "tests/dynamics/physics/measures.h"

namespace visum::bench {
namespace {

constexpr double kTick = 1e-3;

struct StepCase {
  std::string name;
  world::WorldModel model;
  int batch;                        // ticks until it starts again
  Eigen::Vector3d tip;              // in the last body
  const physics::TipAt* reference;  // at the end of the batch; null: none
};

world::EngineSetting any_engine() {
  return physics::engine_rows().front().setting;  // each stepper sets its own
}

std::vector<StepCase> step_cases() {
  using namespace physics;
  const Eigen::Vector3d none = Eigen::Vector3d::Zero();
  return {{"arm7", arm7(any_engine(), kTick), 1000, kArm7Tip, &arm7_tips()[2]},
          {"chain8", chain(any_engine(), kTick, 8), 1000, kChainTip, nullptr},
          {"chain64", chain(any_engine(), kTick, 64), 100, kChainTip, nullptr},
          {"chain512", chain(any_engine(), kTick, 512), 10, kChainTip, nullptr},
          {"fourbars10", four_bars(any_engine(), kTick, 10), 200, none, nullptr},
          {"fourbars20", four_bars(any_engine(), kTick, 20), 200, none, nullptr},
          {"fourbars40", four_bars(any_engine(), kTick, 40), 200, none, nullptr},
          {"stack10", stack(any_engine(), kTick, 10), 1000, none, nullptr}};
}

// Steps one batch, not timed, and measures its errors.
void judge(benchmark::State& state, const StepCase& what, Stepper& stepper) {
  world::WorldState now = initial_state(what.model);
  const double energy = physics::energy_of(what.model, now), scale = physics::energy_scale(what.model);
  double energy_error = 0.0, gap = 0.0;
  stepper.reset();
  for (int i = 1; i <= what.batch; ++i) {
    stepper.step();
    stepper.store(now);
    measure_joints(what.model, now);
    gap = std::max(gap, physics::max_gap(what.model, now));
    if (scale > 0.0)
      energy_error = std::max(energy_error, std::abs(physics::energy_of(what.model, now) - energy) / scale);
  }
  if (scale > 0.0) {
    state.counters["energy_error"] = energy_error;
    state.counters["gap_m"] = gap;
  }
  if (!what.reference) return;
  const world::BodyId last{static_cast<std::int32_t>(what.model.bodies.size() - 1)};
  state.counters["tip_error_m"] =
      (physics::point_of(what.model, now, last, what.tip) - what.reference->p_W).norm();
}

void time_steps(benchmark::State& state, const StepCase& what, Stepper& stepper) {
  stepper.reset();
  int done = 0;
  for (auto _ : state) {
    stepper.step();
    if (++done < what.batch) continue;
    done = 0;
    state.PauseTiming();
    stepper.reset();
    state.ResumeTiming();
  }
}

void step(benchmark::State& state, const StepCase& what, const StepperKind& kind) {
  try {
    const auto stepper = kind.make(what.model, kind.name);
    time_steps(state, what, *stepper);
    judge(state, what, *stepper);
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
  }
}

const bool kRegistered = [] {
  static const std::vector<StepCase> cases = step_cases();
  for (const StepCase& what : cases)
    for (const StepperKind& kind : stepper_kinds())
      if (kind.takes(what.model))
        benchmark::RegisterBenchmark(("Step/" + what.name + "/" + kind.name).c_str(),
                                     [&](benchmark::State& state) { step(state, what, kind); })
            ->Unit(benchmark::kMicrosecond)
            ->MinTime(0.3);
  return true;
}();

}  // namespace
}  // namespace visum::bench

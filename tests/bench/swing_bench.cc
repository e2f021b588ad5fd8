// Work against precision: Swing/arm7/<engine>/<step>us lets the arm swing free for 1 s. The time is CPU time
// per simulated second; the counter tip_error_m compares with the reference.
#include <benchmark/benchmark.h>

#include <cmath>
#include <stdexcept>

#include "tests/bench/stepper_kinds.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/measures.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::bench {
namespace {

constexpr int kSteps_us[] = {12'500, 10'000, 5000, 4000, 2000, 1000, 500, 250};

void swing(benchmark::State& state, const StepperKind& kind, int step_us) {
  const auto model = physics::arm7(physics::engine_rows().front().setting, 1e-6 * step_us);
  const auto& end = physics::arm7_tips()[2];
  const long steps = std::lround(1e6 * end.time_s / step_us);
  try {
    const auto stepper = kind.make(model, kind.name);
    for (auto _ : state) {
      stepper->reset();
      for (long i = 0; i < steps; ++i) stepper->step();
    }
    world::WorldState now = initial_state(model);
    stepper->store(now);
    const world::BodyId last{static_cast<std::int32_t>(model.bodies.size() - 1)};
    state.counters["tip_error_m"] = (physics::point_of(model, now, last, physics::kArm7Tip) - end.p_W).norm();
  } catch (const std::exception& error) {
    state.SkipWithError(error.what());
  }
}

const bool kRegistered = [] {
  for (const StepperKind& kind : stepper_kinds())
    for (const int step_us : kSteps_us)
      benchmark::RegisterBenchmark(("Swing/arm7/" + kind.name + "/" + std::to_string(step_us) + "us").c_str(),
                                   [&kind, step_us](benchmark::State& state) { swing(state, kind, step_us); })
          ->Unit(benchmark::kMillisecond)
          ->MinTime(0.05);
  return true;
}();

}  // namespace
}  // namespace visum::bench

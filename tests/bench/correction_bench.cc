// JointCorrections/ball: how many corrections of a ball joint per second the engine `impulse` makes with
// `solver: iterate`, in a chain of rods (the paper's while loops, section 5: 200,000). A correction is the
// look-ahead of both bodies, the gap and the impulse. Counter: corrections_per_s.
#include <benchmark/benchmark.h>

#include "server/dynamics/impulse/corrector.h"
#include "tests/dynamics/physics/engine_rows.h"
#include "tests/dynamics/physics/serial_models.h"

namespace visum::bench {
namespace {

using namespace dynamics::impulse;

constexpr double kTick = 1e-3;
constexpr int kLinks = 8;

world::WorldModel ball_chain() {
  world::WorldModel model = physics::chain(physics::engine_row("impulse-iterate").setting, kTick, kLinks);
  for (world::Joint& joint : model.joints) joint.kind = world::JointKind::kBall;
  return model;
}

void correct(benchmark::State& state) {
  const world::WorldModel model = ball_chain();
  const world::WorldState start = initial_state(model);
  Plant plant(model, 0);
  Corrector corrector(plant);
  plant.bodies.load(start);
  plant.mechanisms[0].place(plant.bodies, start);
  corrector.prepare(0, kTick);
  int sweep = 0;
  for (auto _ : state) benchmark::DoNotOptimize(corrector.sweep_gaps(0, kTick, 0.0, start, sweep++));
  state.counters["corrections_per_s"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * kLinks, benchmark::Counter::kIsRate);
}
BENCHMARK(correct)->Name("JointCorrections/ball");

}  // namespace
}  // namespace visum::bench

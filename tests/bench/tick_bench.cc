// The whole tick of the arm's scene, by phase: drives, part, collision, engine, publishing. The arm moves all
// the time (each angle swings about its initial value). Each batch starts from the same state.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <string>

#include "server/cycle/simulation.h"
#include "server/gateway/part_table.h"
#include "server/gateway/published.h"
#include "server/scene/scene.h"

namespace visum::bench {
namespace {

cycle::Simulation arm(const std::string& name, const std::string& step = "world") {
  auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml");
  for (auto& engine : scene.world.engines) {
    engine.name = name;
    engine.step = step;
  }
  return cycle::Simulation(std::move(scene));
}

// Sends the seven joints to one side, then to the other, every half second.
void command(cycle::Simulation& simulation, const std::vector<double>& middle) {
  if (simulation.tick_count() % 500 != 0) return;
  const double side = (simulation.tick_count() / 500) % 2 == 0 ? 0.2 : -0.2;
  std::vector<double> angles;
  for (int joint = 0; joint < 7; ++joint) angles.push_back(middle[static_cast<std::size_t>(joint)] + side);
  simulation.write_inputs(0, 0, angles);
}

void tick(benchmark::State& state, const std::string& engine, const std::string& step) {
  auto simulation = arm(engine, step);
  const auto middle = simulation.parts()[0].controller_inputs;
  for (int i = 0; i < 2000; ++i) {
    command(simulation, middle);
    simulation.tick();
  }
  const auto start = simulation.take_snapshot();
  const gateway::PartNumbers numbers(simulation);
  gateway::Published published;
  for (auto _ : state) {
    command(simulation, middle);
    simulation.tick();
    gateway::fill(published, simulation, {}, numbers.table());
    if (simulation.tick_count() == 22'000) {
      state.PauseTiming();
      if (!simulation.restore_snapshot(start).done()) state.SkipWithError("the snapshot is gone");
      state.ResumeTiming();
    }
  }
  const auto phases = simulation.phases().summary();
  for (std::size_t i = 0; i < cycle::kPhases; ++i)
    state.counters[std::string(cycle::kPhaseNames[i]) + "_ns"] = static_cast<double>(phases[i].mean_ns);
  state.counters["sim_per_wall"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * 1e-3, benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(tick, arm / impulse, std::string("impulse"), std::string("world"))
    ->Name("Tick/arm/impulse")
    ->Unit(benchmark::kMicrosecond)
    ->MinTime(3.0);
BENCHMARK_CAPTURE(tick, arm / ode, std::string("ode"), std::string("world"))
    ->Name("Tick/arm/ode")
    ->Unit(benchmark::kMicrosecond)
    ->MinTime(3.0);
BENCHMARK_CAPTURE(tick, arm / ode - quick, std::string("ode"), std::string("quick"))
    ->Name("Tick/arm/ode-quick")
    ->Unit(benchmark::kMicrosecond)
    ->MinTime(3.0);

void snapshot(benchmark::State& state) {
  auto simulation = arm("ode");
  simulation.tick();
  for (auto _ : state) benchmark::DoNotOptimize(simulation.take_snapshot());
}
BENCHMARK(snapshot)->Name("Snapshot/arm")->Unit(benchmark::kMicrosecond);

void hash(benchmark::State& state) {
  auto simulation = arm("ode");
  simulation.tick();
  for (auto _ : state) benchmark::DoNotOptimize(simulation.state_hash());
}
BENCHMARK(hash)->Name("StateHash/arm")->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace visum::bench

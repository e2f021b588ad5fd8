// The arm's scene in lockstep with everything in: drives, part, collision, engine, publishing. A controller
// connected over TCP writes every 10 ms of simulated time and reads the part's sample. sim_per_wall is
// simulated seconds per second. The daemon's and the controller's thread share the cores that the process
// has; for one core, run it under `taskset -c 1`.
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <thread>

#include "clients/cpp/visum.h"
#include "server/cycle/simulation.h"
#include "server/gateway/daemon.h"

namespace visum::bench {
namespace {

constexpr int kPeriodMs = 10;
constexpr double kSwingRad = 0.2;

void controlled(benchmark::State& state, const std::string& engine) {
  auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml");
  for (auto& setting : scene.world.engines) setting.name = engine;
  scene.clock = scene::ClockKind::kLockstep;
  cycle::Simulation simulation(std::move(scene));
  gateway::DaemonOptions options;
  options.port = 0;
  gateway::Daemon daemon(simulation, options);
  std::thread server([&] { daemon.run(); });
  {
    Client client("127.0.0.1:" + std::to_string(daemon.port()));
    Part arm = client.part("arm");
    arm.acquire();
    Inputs desired = arm.inputs("Desired Angle");
    Outputs actual = arm.outputs("Actual Angle");
    const std::vector<double> middle = actual.values();
    client.join();
    double time_s = 0.0;
    for (auto _ : state) {
      // Each joint swings about its first angle, once in 2 s.
      const double away = kSwingRad * std::sin(std::numbers::pi * time_s);
      for (std::size_t i = 0; i < desired.size(); ++i) desired.set(i, middle[i] + away);
      arm.write();
      client.advance_ms(kPeriodMs);
      time_s += 1e-3 * kPeriodMs;
      benchmark::DoNotOptimize(actual[0]);
    }
    arm.release();
  }
  daemon.stop();
  server.join();
  state.counters["sim_per_wall"] = benchmark::Counter(
      1e-3 * kPeriodMs * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}
BENCHMARK_CAPTURE(controlled, ode, std::string("ode"))
    ->Name("Lockstep/arm/ode")
    ->Unit(benchmark::kMicrosecond)
    ->MinTime(3.0)
    ->UseRealTime();
BENCHMARK_CAPTURE(controlled, impulse, std::string("impulse"))
    ->Name("Lockstep/arm/impulse")
    ->Unit(benchmark::kMicrosecond)
    ->MinTime(3.0)
    ->UseRealTime();

}  // namespace
}  // namespace visum::bench

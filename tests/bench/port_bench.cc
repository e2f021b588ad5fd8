// Round trip of a port: write one vector of 22 controller inputs, read the reply; beside a raw TCP echo of
// the same bytes. Both take turns within one run, each with a blocking client thread and a server thread of
// its own, so that the machine's noise falls on both. The figure is the ratio.
#include <benchmark/benchmark.h>

#include <filesystem>
#include <thread>

#include "protocol/client.h"
#include "protocol/codec.h"
#include "server/cycle/simulation.h"
#include "server/gateway/daemon.h"
#include "tests/bench/percentiles.h"
#include "tests/protocol/raw_echo.h"

namespace visum::bench {
namespace {

using Clock = std::chrono::steady_clock;

std::size_t frame_bytes(const protocol::Request& request) {
  std::vector<std::byte> bytes;
  protocol::encode_request(1000, request, bytes);
  return bytes.size();
}

std::size_t frame_bytes(const protocol::Reply& reply) {
  std::vector<std::byte> bytes;
  protocol::encode_reply(1000, reply, bytes);
  return bytes.size();
}

template <typename Action>
void timed(Percentiles& into, Action action) {
  const auto start = Clock::now();
  action();
  into.add(Clock::now() - start);
}

void round_trip(benchmark::State& state) {
  // The world steps with nobody: the daemon's one thread only answers. In clock realtime the sessions' thread
  // does.
  auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml");
  scene.clock = scene::ClockKind::kLockstep;
  cycle::Simulation simulation(std::move(scene));
  gateway::DaemonOptions options;
  options.port = 0;
  gateway::Daemon daemon(simulation, options);
  std::thread server([&] { daemon.run(); });

  protocol::Connection client("127.0.0.1", daemon.port(), {1, 1, "bench", protocol::Role::kAdmin, {}});
  client.request(protocol::AcquireLease{"arm", 0, false});
  const protocol::Write write{"arm", 0, simulation.parts()[0].controller_inputs, 0};
  testing::RawEchoServer echo(frame_bytes(protocol::Request(write)),
                              frame_bytes(protocol::Reply(protocol::Ok{})));
  {
    testing::RawEchoClient raw(echo.port(), frame_bytes(protocol::Request(write)),
                               frame_bytes(protocol::Reply(protocol::Ok{})));
    Percentiles ours(1 << 20), bare(1 << 20);
    for (auto _ : state) {
      timed(bare, [&] { raw.round_trip(); });
      timed(ours, [&] { client.request(write); });
      // The tick empties the mailbox; without it the latched inputs would pile up. Not timed.
      if (ours.count() % 256 == 0) client.request(protocol::Step{1});
    }
    state.counters["visum_p50_us"] = ours.at(0.5);
    state.counters["visum_p99_us"] = ours.at(0.99);
    state.counters["visum_max_us"] = ours.at(1.0);
    state.counters["raw_p50_us"] = bare.at(0.5);
    state.counters["raw_p99_us"] = bare.at(0.99);
    state.counters["raw_max_us"] = bare.at(1.0);
    state.counters["p50_ratio"] = ours.at(0.5) / bare.at(0.5);
  }
  daemon.stop();
  server.join();
}
BENCHMARK(round_trip)
    ->Name("PortRoundTrip/write22")
    ->Unit(benchmark::kMicrosecond)
    ->Iterations(20'000)
    ->UseRealTime();

}  // namespace
}  // namespace visum::bench

// Round trip of a port: write one vector of 22 controller inputs, read the reply. Beside it, a raw TCP echo
// of the same bytes. Both take turns within one run, each with a blocking client thread and a server thread
// of its own on the same cores, so the machine's noise hits both. The figure to read is their ratio.
#include <benchmark/benchmark.h>
#include <pthread.h>
#include <sched.h>

#include <filesystem>
#include <stdexcept>
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

// The cores to which client and server are pinned. Waking a thread on another, halted core costs more than
// everything else here. A latency without its layout therefore says little, and a ratio of two layouts
// nothing.
enum class Cores { kOne, kTwo };

cpu_set_t allowed_cores() {
  cpu_set_t cores;
  if (::sched_getaffinity(0, sizeof cores, &cores) != 0) throw std::runtime_error("sched_getaffinity");
  return cores;
}

// The cores that the process began with: a pinned thread sees only its own.
int nth_core(int n) {
  static const cpu_set_t cores = allowed_cores();
  for (int core = 0; core < CPU_SETSIZE; ++core)
    if (CPU_ISSET(core, &cores) && n-- == 0) return core;
  throw std::runtime_error("this machine has too few cores for the layout");
}

void pin(pthread_t thread, const cpu_set_t& cores) {
  if (::pthread_setaffinity_np(thread, sizeof cores, &cores) != 0)
    throw std::runtime_error("pthread_setaffinity_np");
}

cpu_set_t only(int core) {
  cpu_set_t cores;
  CPU_ZERO(&cores);
  CPU_SET(core, &cores);
  return cores;
}

// Pins this thread to the cores of a layout's server or client while it lives. Threads that it starts inherit
// them.
class Placed {
 public:
  Placed(Cores layout, bool server) : before_(allowed_cores()) {
    const int core = nth_core(layout == Cores::kTwo && server ? 1 : 0);
    pin(::pthread_self(), only(core));
  }
  ~Placed() { ::pthread_setaffinity_np(::pthread_self(), sizeof before_, &before_); }
  Placed(const Placed&) = delete;
  Placed& operator=(const Placed&) = delete;

 private:
  cpu_set_t before_;
};

template <typename Message, typename Encode>
std::size_t frame_bytes(const Message& message, Encode encode) {
  std::vector<std::byte> bytes;
  encode(1000, message, bytes);
  return bytes.size();
}

template <typename Action>
void timed(Percentiles& into, Action action) {
  const auto start = Clock::now();
  action();
  into.add(Clock::now() - start);
}

void report(benchmark::State& state, const std::string& who, Percentiles& times) {
  state.counters[who + "_p50_us"] = times.at(0.5);
  state.counters[who + "_p99_us"] = times.at(0.99);
  state.counters[who + "_max_us"] = times.at(1.0);
}

// A daemon with the arm's scene, on a thread of its own.
class RunningDaemon {
 public:
  RunningDaemon(scene::ClockKind clock, Cores layout)
      : simulation_(arm_scene(clock)), daemon_(simulation_, any_port()) {
    const Placed placed(layout, true);
    thread_ = std::thread([this] { daemon_.run(); });
  }
  ~RunningDaemon() {
    daemon_.stop();
    thread_.join();
  }
  RunningDaemon(const RunningDaemon&) = delete;
  RunningDaemon& operator=(const RunningDaemon&) = delete;

  std::uint16_t port() const { return daemon_.port(); }

 private:
  static scene::Scene arm_scene(scene::ClockKind clock) {
    auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml");
    scene.clock = clock;
    return scene;
  }
  static gateway::DaemonOptions any_port() {
    gateway::DaemonOptions options;
    options.port = 0;
    return options;
  }

  cycle::Simulation simulation_;
  gateway::Daemon daemon_;
  std::thread thread_;
};

// Waits for a tick after the present one, because an Advance of a member that is behind is answered at once.
void pass_tick(protocol::Connection& client) {
  const auto advance = [&] { return client.request_as<protocol::Advanced>(protocol::Advance{1}).tick; };
  const std::int64_t now = advance();
  while (advance() == now) {
  }
}

// In lockstep one thread of the daemon answers while the world stands. In realtime the sessions' thread
// answers while another thread ticks 1000 times a second.
void round_trip(benchmark::State& state, scene::ClockKind clock, Cores layout) {
  RunningDaemon daemon(clock, layout);
  const Placed placed(layout, false);
  protocol::Connection client("127.0.0.1", daemon.port(), {1, 1, "bench", protocol::Role::kAdmin, {}});
  client.request(protocol::AcquireLease{"arm", 0, false});
  const bool stands = clock == scene::ClockKind::kLockstep;
  if (stands)
    client.request(protocol::Pause{});
  else
    client.request(protocol::Join{});
  const auto inputs = client.request_as<protocol::PartSample>(protocol::Read{"arm"}).controller_inputs;
  const protocol::Write write{"arm", 0, inputs, 0};
  const auto request_bytes = frame_bytes(protocol::Request(write), protocol::encode_request);
  const auto reply_bytes = frame_bytes(protocol::Reply(protocol::Ok{}), protocol::encode_reply);

  std::optional<Placed> echo_place(std::in_place, layout, true);
  testing::RawEchoServer echo(request_bytes, reply_bytes);
  echo_place.reset();
  testing::RawEchoClient raw(echo.port(), request_bytes, reply_bytes);
  Percentiles ours(1 << 20), bare(1 << 20);
  for (auto _ : state) {
    timed(bare, [&] { raw.round_trip(); });
    timed(ours, [&] { client.request(write); });
    // The latched inputs are bounded, and only a tick empties them. This is not timed.
    if (ours.count() % 4 != 0) continue;
    if (stands)
      client.request(protocol::Step{1});
    else
      pass_tick(client);
  }
  report(state, "visum", ours);
  report(state, "raw", bare);
  state.counters["request_bytes"] = static_cast<double>(request_bytes);
  state.counters["p50_ratio"] = ours.at(0.5) / bare.at(0.5);
}

void register_round_trip(const char* name, scene::ClockKind clock, Cores layout) {
  benchmark::RegisterBenchmark(name, [=](benchmark::State& state) { round_trip(state, clock, layout); })
      ->Unit(benchmark::kMicrosecond)
      ->Iterations(20'000)
      ->UseRealTime();
}

const bool kRegistered = [] {
  using scene::ClockKind;
  register_round_trip("PortRoundTrip/write22/one-core", ClockKind::kLockstep, Cores::kOne);
  register_round_trip("PortRoundTrip/write22/two-cores", ClockKind::kLockstep, Cores::kTwo);
  register_round_trip("PortRoundTrip/write22/realtime/one-core", ClockKind::kRealtime, Cores::kOne);
  register_round_trip("PortRoundTrip/write22/realtime/two-cores", ClockKind::kRealtime, Cores::kTwo);
  return true;
}();

}  // namespace
}  // namespace visum::bench

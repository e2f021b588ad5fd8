// The tick in which a model of 30 links appears in a running world, beside the ticks before it, as the daemon
// makes them in real time: what waits is taken, the world ticks, and a copy is made for the sessions.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <semaphore>
#include <string>
#include <vector>

#include "server/gateway/published.h"
#include "server/gateway/tick_side.h"
#include "server/scene/scene.h"

namespace visum::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kLinks = 30;

// An arm of 30 links that turn, with a sphere each.
std::string chain() {
  std::string robot = "<robot name=\"chain\">\n  <link name=\"l0\"/>\n";
  for (int i = 1; i < kLinks; ++i) {
    const std::string link = "l" + std::to_string(i), before = "l" + std::to_string(i - 1);
    robot += "  <link name=\"" + link +
             "\"><inertial><mass value=\"0.5\"/><inertia ixx=\"1e-3\" iyy=\"1e-3\" izz=\"1e-3\" ixy=\"0\" "
             "ixz=\"0\" iyz=\"0\"/></inertial><collision><geometry><sphere radius=\"0.02\"/></geometry>"
             "</collision></link>\n  <joint name=\"j" +
             std::to_string(i) + "\" type=\"revolute\"><parent link=\"" + before + "\"/><child link=\"" +
             link +
             "\"/><origin xyz=\"0.1 0 0\"/><axis xyz=\"0 0 1\"/><limit lower=\"-1\" upper=\"1\" "
             "velocity=\"1\" effort=\"50\"/></joint>\n";
  }
  return robot + "</robot>\n";
}

class Daemon {
 public:
  Daemon() {
    tick_side_.on_change_ready([this] { ready_.release(); });
    for (int i = 0; i < 500; ++i) tick();
  }
  ~Daemon() { tick_side_.end_changes(); }

  double tick() {
    const auto begin = Clock::now();
    tick_side_.empty_mailbox();
    tick_side_.tick();
    fill(copy_, simulation_, tick_side_.pace(), tick_side_.part_table());
    tick_side_.give_back();
    return std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
  }
  // Returns once the request is ready to act in the next tick.
  void ask(protocol::Request request) {
    mailbox_.send(
        std::make_unique<gateway::Command>(gateway::Command{1, 1, 0, 0, std::move(request), false, {}, {}}));
    tick();
    ready_.acquire();
  }
  // True if the last request was done.
  bool done() {
    const auto command = mailbox_.next_done();
    return command && !std::holds_alternative<protocol::Error>(command->reply);
  }

 private:
  static scene::Scene scene_of_arm() {
    auto scene = scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml");
    scene.clock = scene::ClockKind::kRealtime;
    return scene;
  }
  cycle::Simulation simulation_{scene_of_arm()};
  gateway::Mailbox mailbox_{64};
  std::counting_semaphore<> ready_{0};
  gateway::TickSide tick_side_{simulation_, mailbox_, true};
  gateway::Published copy_;
};

void spawn_tick(benchmark::State& state) {
  Daemon daemon;
  protocol::SpawnModel model{"chain.urdf", "chain", {0, 3, 1, 1, 0, 0, 0}, false, {{"chain.urdf", chain()}}};
  std::vector<double> before, with, after;
  for (auto _ : state) {
    for (int i = 0; i < 50; ++i) before.push_back(daemon.tick());
    daemon.ask(model);
    with.push_back(daemon.tick());
    state.SetIterationTime(with.back() * 1e-6);
    if (!daemon.done()) return state.SkipWithError("the model did not come");
    for (int i = 0; i < 50; ++i) after.push_back(daemon.tick());
    daemon.ask(protocol::RemoveModel{"chain"});
    daemon.tick();
    if (!daemon.done()) return state.SkipWithError("the model did not go");
  }
  const auto quantile = [](std::vector<double>& all, double share) {
    std::ranges::sort(all);
    return all[static_cast<std::size_t>(share * static_cast<double>(all.size() - 1))];
  };
  state.counters["before_us"] = quantile(before, 0.5);
  state.counters["with_us"] = quantile(with, 0.5);
  state.counters["with_max_us"] = with.back();
  state.counters["after_us"] = quantile(after, 0.5);
}
BENCHMARK(spawn_tick)->Name("Spawn/30_links")->UseManualTime()->Iterations(50)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace visum::bench

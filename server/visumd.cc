// visumd: the daemon that holds a world and publishes its parts. The one file that knows everyone.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <string>
#include <string_view>

#include "server/cycle/simulation.h"
#include "server/gateway/command_line.h"
#include "server/gateway/daemon.h"
#include "server/gateway/program.h"
#include "server/gateway/scene_check.h"
#include "server/scene/scene.h"

namespace {

using namespace visum;

struct Options {
  std::string scene;
  std::string clock;
  double speedup = 0.0;
  std::int64_t seed = -1;
  gateway::Talk talk;
  std::vector<std::string> buses;
  gateway::HttpWords http;
  scene::Options of_scene;
  gateway::DaemonOptions of_daemon;
};

scene::Scene load(const Options& options) {
  auto scene = scene::load_scene(options.scene, options.of_scene);
  if (options.clock == "realtime") scene.clock = scene::ClockKind::kRealtime;
  if (options.clock == "lockstep") scene.clock = scene::ClockKind::kLockstep;
  if (options.clock == "free") scene.clock = scene::ClockKind::kFree;
  if (options.speedup > 0.0) scene.speed = options.speedup;
  if (options.seed >= 0) scene.seed = static_cast<std::uint64_t>(options.seed);
  for (const auto& loss : scene.losses) spdlog::warn("{}", loss);
  for (const auto& note : scene.notes) spdlog::debug("{}", note);
  return scene;
}

int run(Options options) {
  cycle::Simulation simulation(load(options));
  for (const auto& bus : options.buses)
    options.of_daemon.buses.push_back(gateway::parse_bus(bus, simulation.scene()));
  options.of_daemon.http = options.http.settled(options.of_daemon);
  gateway::Daemon daemon(simulation, options.of_daemon);
  const int signal = gateway::run_until_signal(daemon, simulation, options.of_daemon, options.talk.json);
  if (simulation.frozen())
    spdlog::error("the world froze at tick {}: {}", simulation.tick_count(), simulation.fault());
  spdlog::info("ended at tick {}", simulation.tick_count());
  if (signal == SIGINT) return gateway::kInterrupted;
  return simulation.frozen() ? gateway::kFailed : gateway::kPassed;
}

void declare(CLI::App& app, Options& options) {
  app.add_option("scene", options.scene, "the scene, a YAML file")->required()->type_name("SCENE.yaml");
  gateway::declare_common(app, options.of_daemon, options.talk);
  gateway::declare_http(app, options.of_daemon, options.http);
  app.add_option("--clock", options.clock, "instead of the scene's: realtime, lockstep or free")
      ->check(CLI::IsMember({"realtime", "lockstep", "free"}));
  app.add_option("--speedup", options.speedup, "realtime: simulated seconds per second")
      ->check(CLI::Range(1e-3, 1e3));
  app.add_option("--seed", options.seed, "of the world's random numbers, instead of the scene's")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--engine", options.of_scene.engine, "moves all bodies, instead of the scene's engines");
  app.add_option("--bus", options.buses,
                 "PART=KIND:WHERE, a field bus to the part's modules; repeatable. KIND:WHERE is pty:PATH,\n"
                 "tcp:PORT, slcan:PATH or socketcan:INTERFACE, then ,baud=N and ,delay_ms=X if wanted")
      ->type_name("BUS");
  app.add_flag("-r,--run", options.of_daemon.run_at_once,
               "let time run at once, not from the first lease on");
  app.set_version_flag("--version", "visumd " VISUM_VERSION);
  app.footer(
      "Examples:\n"
      "  visumd models/scenes/amtec_arm.yaml                       the arm in real time on 127.0.0.1:1500\n"
      "  visumd models/scenes/amtec_arm.yaml --clock lockstep --port 0 --json\n"
      "  visumd models/scenes/amtec_arm.yaml --bus arm=pty:arm.tty   with its modules on a serial line, too\n"
      "  visumd check models/scenes/amtec_arm.yaml                 says what is wrong with a scene, no more\n"
      "Exit codes: 0 ended in good order, 1 the world froze, 2 bad usage, 3 the scene is wrong, 130 "
      "interrupted.");
}

int check(int argc, char** argv) {
  std::string scene;
  scene::Options of_scene;
  gateway::Talk talk{.verbosity = 1};
  CLI::App app{"visumd check: says what is wrong with a scene, where, and what was meant"};
  app.add_option("scene", scene, "the scene, a YAML file")->required()->type_name("SCENE.yaml");
  app.add_option("--engine", of_scene.engine, "moves all bodies, instead of the scene's engines");
  app.add_flag("--json", talk.json, "print one line of JSON");
  app.footer(
      "Example:\n"
      "  visum check models/scenes/cart.yaml\n"
      "Exit codes: 0 the scene is right, 2 bad usage, 3 the scene is wrong.");
  return gateway::run_command(app, argc, argv, "visumd", talk, [&] {
    gateway::check_scene(scene, of_scene, talk.json);
    return gateway::kPassed;
  });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "check") return check(argc - 1, argv + 1);
  Options options;
  CLI::App app{"visumd: holds a physics world and publishes its hardware parts over TCP"};
  declare(app, options);
  return gateway::run_command(app, argc, argv, "visumd", options.talk, [&] { return run(options); });
}

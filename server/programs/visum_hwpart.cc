// visum-hwpart: serves a part of a scene with real modules behind it. Ports and protocol are those of visumd,
// so a controller only changes host and port.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <csignal>
#include <memory>
#include <stdexcept>
#include <string>

#include "protocol/command_line/parse.h"
#include "protocol/config/unknown_name.h"
#include "server/bus/host_connection.h"
#include "server/cycle/simulation.h"
#include "server/gateway/daemon.h"
#include "server/programs/command_line.h"
#include "server/programs/program.h"
#include "server/scene/scene.h"

namespace {

using namespace visum;

struct Options {
  std::string scene;
  std::string part;
  std::string bus;
  double speedup = 1.0;
  double answer_ms = 50.0;
  programs::OutputOptions output;
  hwparts::RealOptions of_part;
  gateway::DaemonOptions of_daemon;
};

// The part of this name; without a name, the only one there is.
scene::PartPlan pick_part(const scene::Scene& scene, const std::string& wanted) {
  std::vector<std::string> names;
  for (const auto& plan : scene.parts) {
    if (plan.context.name == wanted || (wanted.empty() && scene.parts.size() == 1)) return plan;
    names.push_back(plan.context.name);
  }
  if (!wanted.empty()) throw std::runtime_error("--part: " + config::unknown_name("part", wanted, names));
  std::string known;
  for (const auto& name : names) known += (known.empty() ? "" : ", ") + name;
  throw std::runtime_error("--part must name one of the scene's parts: " + known);
}

// The scene's part without the scene's world: real modules need no simulated bodies.
scene::Scene only_the_part(const scene::Scene& whole, const Options& options) {
  scene::Scene scene;
  scene.name = whole.name;
  scene.file = whole.file;
  scene.world.name = whole.world.name;
  scene.world.tick_ns = whole.world.tick_ns;
  scene.parts = {pick_part(whole, options.part)};
  scene.clock = scene::ClockKind::kRealtime;
  scene.speed = options.speedup;
  return scene;
}

int run(Options options) {
  scene::Options of_scene;
  of_scene.plugin_folders = plugin::plugin_folders({});
  const auto scene = only_the_part(scene::load_scene(options.scene, of_scene), options);
  const auto line = bus::open_host_connection(options.bus);
  options.of_part.answer_ns = static_cast<std::int64_t>(options.answer_ms * 1e6);
  cycle::Simulation simulation(scene, [&](const std::string& kind, const hwparts::PartContext& context) {
    return hwparts::make_real_part(kind, context, *line, options.of_part);
  });
  auto& part = *simulation.parts().front().part;
  options.of_daemon.program = "visum-hwpart";
  options.of_daemon.simulated = options.of_daemon.has_world = false;
  options.of_daemon.run_at_once = true;
  options.of_daemon.wait = [&](std::chrono::steady_clock::time_point due) {
    const auto due_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(due.time_since_epoch()).count();
    do {
      part.pump();
      line->wait_until(due_ns);
    } while (line->now_ns() < due_ns);
  };
  gateway::Daemon daemon(simulation, options.of_daemon);
  spdlog::info("{}: all modules of '{}' answer", line->name(), part.description().name);
  const int signal = programs::run_until_signal(daemon, simulation, options.of_daemon, options.output.json);
  part.stand_down();
  spdlog::info("ended");
  return signal == SIGINT ? programs::kInterrupted : programs::kPassed;
}

void declare(CLI::App& app, Options& options) {
  app.add_option("scene", options.scene, "the scene that the part stands in, a YAML file")
      ->required()
      ->type_name("SCENE.yaml");
  app.add_option("--bus", options.bus,
                 "where the modules are: serial:DEVICE,BAUD, tcp:HOST:PORT, slcan:DEVICE[,KBAUD] or "
                 "socketcan:INTERFACE")
      ->required()
      ->type_name("BUS");
  app.add_option("--part", options.part, "the part's name; needed if the scene has several parts");
  programs::declare_common(app, options.of_daemon, options.output);
  programs::declare_cache(app);
  app.add_flag("--execution-enable", options.of_part.execution_enable,
               "let the port Execution Enable start as 1 instead of 0; only an operator should say so");
  app.add_flag("--watchdog", options.of_part.watchdog,
               "let the modules stop by themselves when nothing serves their watchdogs any more");
  app.add_option("--answer-ms", options.answer_ms,
                 "milliseconds to wait for an answer; a request is tried three times")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 1e4));
  app.add_option("--speedup", options.speedup,
                 "how much faster than the wall clock the modules' time runs; for simulated modules only")
      ->capture_default_str()
      ->check(CLI::Range(1e-3, 1e3));
  command_line::add_version(app);
  app.footer(
      "Nothing moves at the start, nor before a controller writes Execution Enable.\n"
      "Example:\n"
      "  visum-hwpart models/scenes/amtec_arm.yaml --bus serial:/dev/ttyUSB0,38400\n"
      "Exit codes: 0 ended in good order, 2 bad usage or a bus without this part's modules, 3 the scene is "
      "wrong, 130 interrupted.");
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{"Serves a hardware part whose modules are real", "visum-hwpart"};
  declare(app, options);
  return programs::run_command(app, {argc, argv, "visum-hwpart"}, "visum-hwpart", options.output,
                               [&] { return run(options); });
}

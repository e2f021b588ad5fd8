// visumd: the daemon that holds a world and publishes its parts. The one file that knows everyone.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "server/cycle/simulation.h"
#include "server/gateway/daemon.h"
#include "server/gateway/playback.h"
#include "server/programs/command_line.h"
#include "server/programs/node_watch.h"
#include "server/programs/program.h"
#include "server/programs/replay_report.h"
#include "server/programs/scene_check.h"
#include "server/programs/scene_convert.h"
#include "server/recording/export_csv.h"
#include "server/recording/flight_recorder.h"
#include "server/recording/log_sink.h"
#include "server/recording/new_file.h"
#include "server/recording/recorder.h"
#include "server/recording/replay.h"
#include "server/scene/scene.h"

namespace {

using namespace visum;

constexpr const char* kRecordHelp = "write down every input, port and state's hash: an MCAP file";
constexpr const char* kParametersHelp =
    "values of the scene's parameters, instead of their defaults: \"{mass: 2, friction: 0.4}\"";

// A service manager's word, else here.
std::string state_folder() {
  const char* folder = std::getenv("STATE_DIRECTORY");
  return folder && *folder ? folder : ".";
}

struct Options {
  std::string scene;
  std::string clock;
  double speedup = 0.0;
  std::int64_t seed = -1;
  programs::OutputOptions talk;
  std::vector<std::string> buses;
  programs::PluginOptions plugins;
  programs::HttpArguments http;
  std::string record;                                     // a file; empty: none
  std::string dump = state_folder();                      // where the ticks before a freeze go; or "off"
  std::string rewound;                                    // a recording to go on from, instead of a scene
  double at_s = std::numeric_limits<double>::infinity();  // where in it
  scene::Options of_scene;
  gateway::DaemonOptions of_daemon;
};

scene::Options with_plugins(scene::Options options, const programs::PluginOptions& words) {
  options.plugin_folders = plugin::plugin_folders(words.folders);
  return options;
}

void set_clock(const Options& options, scene::Scene& scene) {
  if (!options.clock.empty()) scene.clock = scene::clock_of(options.clock);
  if (options.speedup > 0.0) scene.speed = options.speedup;
}

scene::Scene load(const Options& options) {
  auto scene = scene::load_scene(options.scene, with_plugins(options.of_scene, options.plugins));
  set_clock(options, scene);
  if (options.seed >= 0) scene.seed = static_cast<std::uint64_t>(options.seed);
  for (const auto& loss : scene.losses) spdlog::warn("{}", loss);
  for (const auto& note : scene.notes) spdlog::debug("{}", note);
  return scene;
}

// What the daemon runs, of a scene or of a recording.
recording::Rewound make_world(const Options& options) {
  if (!options.rewound.empty()) {
    std::error_code not_there;
    if (std::filesystem::equivalent(options.rewound, options.record, not_there))
      throw std::runtime_error("--record " + options.record + " is the recording to go on from");
    return recording::rewind(
        options.rewound, options.at_s, [&](scene::Scene& scene) { set_clock(options, scene); },
        plugin::plugin_folders(options.plugins.folders), options.of_scene.engine);
  }
  config::FilesNoted noted;
  auto world = std::make_unique<cycle::Simulation>(load(options));
  return {std::move(world), {std::move(noted.files), options.of_scene.engine, options.of_scene.parameters}};
}

// All that happens in the world, while it lives. The daemon comes before it: who cannot have the port must
// not empty a file.
class Logbook {
 public:
  Logbook(cycle::Simulation& simulation, const recording::Origin& origin, const std::string& file,
          recording::LogSink& log)
      : recorder_(simulation, origin, file), log_(log) {
    log_.follow(&recorder_);
  }
  ~Logbook() { log_.follow(nullptr); }

 private:
  recording::Recorder recorder_;
  recording::LogSink& log_;
};

int run(Options options) {
  const programs::NodeWatch watch(options.plugins.node_timeout());
  options.of_daemon.stuck_node = [&watch] { return watch.stuck(); };
  auto [world, origin] = make_world(options);
  auto& simulation = *world;
  std::optional<recording::LogSink> log;
  std::optional<recording::FlightRecorder> flight;
  if (!options.record.empty())
    log.emplace();
  else if (options.dump != "off")
    options.of_daemon.flight = &flight.emplace(simulation, origin, options.dump);
  for (const auto& bus : options.buses)
    options.of_daemon.buses.push_back(bus::parse_bus(bus, simulation.scene()));
  options.of_daemon.http = options.http.settled(options.of_daemon);
  options.of_daemon.paced = options.speedup > 0.0;
  gateway::Daemon daemon(simulation, options.of_daemon);
  std::optional<Logbook> logbook;
  if (log) logbook.emplace(simulation, origin, options.record, *log);
  const int signal = programs::run_until_signal(daemon, simulation, options.of_daemon, options.talk.json);
  if (simulation.frozen())
    spdlog::error("the world froze at tick {}: {}", simulation.tick_count(), simulation.fault());
  spdlog::info("ended at tick {}", simulation.tick_count());
  if (signal == SIGINT) return programs::kInterrupted;
  return simulation.frozen() ? programs::kFailed : programs::kPassed;
}

// What the world is made of: a scene, or a recording of one, which fixes the seed.
void declare_world(CLI::App& app, Options& options, std::string_view verb) {
  if (verb == "record")
    app.add_option("recording", options.record, kRecordHelp)->required()->type_name("FILE.mcap");
  else
    app.add_option("--record", options.record, kRecordHelp)->type_name("FILE.mcap");
  app.add_option(
         "--dump", options.dump,
         "where the last thousand ticks go if the world freezes and --record is not given; or off. Default: "
         "$STATE_DIRECTORY, or the working directory")
      ->type_name("FOLDER|off");
  if (verb == "rewind") {
    app.add_option("recording", options.rewound, "the run to go on from")->required()->type_name("FILE.mcap");
    app.add_option("--at", options.at_s, "simulated seconds from its beginning; default: its end")
        ->check(CLI::NonNegativeNumber);
    app.add_option("--engine", options.of_scene.engine,
                   "moves all bodies from there on, instead of the run's");
    return;
  }
  app.add_option("scene", options.scene, "the scene, a YAML file")->required()->type_name("SCENE.yaml");
  app.add_option("--seed", options.seed, "of the world's random numbers, instead of the scene's")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--engine", options.of_scene.engine, "moves all bodies, instead of the scene's engines");
  app.add_option("--parameters", options.of_scene.parameters, kParametersHelp)->type_name("YAML");
}

void declare(CLI::App& app, Options& options) {
  programs::declare_common(app, options.of_daemon, options.talk);
  programs::declare_http(app, options.of_daemon, options.http);
  app.add_option("--clock", options.clock, "instead of the scene's: realtime, lockstep or free")
      ->check(CLI::IsMember(std::vector<std::string>{scene::kClockNames.begin(), scene::kClockNames.end()}));
  app.add_option("--speedup", options.speedup,
                 "simulated seconds per second: in realtime the pace, in lockstep at most")
      ->check(CLI::Range(1e-3, 1e3));
  programs::declare_plugins(app, options.plugins);
  programs::declare_node_timeout(app, options.plugins);
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
      "  visumd models/scenes/amtec_arm.yaml --record run.mcap     `visum replay run.mcap` goes through it "
      "again\n"
      "  visumd rewind run.mcap --at 12.5                          goes on from there; with another\n"
      "                                                            engine: --engine NAME\n"
      "  visumd check models/scenes/amtec_arm.yaml                 says what is wrong with a scene, no more\n"
      "Exit codes: 0 ended in good order, 1 the world froze, 2 bad usage, 3 the scene is wrong, 124 a\n"
      "plug-in hangs, 130 interrupted.");
}

int check(int argc, char** argv) {
  std::string scene;
  programs::PluginOptions plugins;
  scene::Options of_scene;
  programs::OutputOptions talk{.verbosity = 1};
  CLI::App app{"visumd check: says what is wrong with a scene, where, and what was meant"};
  app.add_option("scene", scene, "the scene, a YAML file")->required()->type_name("SCENE.yaml");
  app.add_option("--engine", of_scene.engine, "moves all bodies, instead of the scene's engines");
  app.add_option("--parameters", of_scene.parameters, kParametersHelp)->type_name("YAML");
  programs::declare_plugins(app, plugins);
  programs::declare_node_timeout(app, plugins);
  app.add_flag("--json", talk.json, "print one line of JSON");
  app.footer(
      "Example:\n"
      "  visum check models/scenes/cart.yaml\n"
      "Exit codes: 0 the scene is right, 2 bad usage, 3 the scene is wrong, 124 a plug-in hangs.");
  return programs::run_command(app, argc, argv, "visumd", talk, [&] {
    const programs::NodeWatch watch(plugins.node_timeout());
    programs::check_scene(scene, with_plugins(of_scene, plugins), talk.json);
    return programs::kPassed;
  });
}

int convert(int argc, char** argv) {
  std::string from, to;
  programs::PluginOptions plugins;
  programs::OutputOptions talk{.verbosity = 1};
  CLI::App app{"visumd convert: writes a scene in another format, and says what that cannot hold"};
  app.add_option("FROM", from, "a scene: .yaml, .urdf, .sdf, .x3d, .x3dv or .wrl")->required();
  app.add_option("TO", to, "what to write: .yaml, .sdf, .x3d, .x3dv or .wrl")->required();
  programs::declare_plugins(app, plugins);
  app.add_flag("--json", talk.json, "print one line of JSON");
  app.footer(
      "Examples:\n"
      "  visum convert models/scenes/hall.yaml hall.x3d\n"
      "  visum convert hall.x3d hall.yaml\n"
      "Exit codes: 0 all is there, 1 written, but for what is listed, 2 bad usage, 3 the scene is wrong.");
  return programs::run_command(app, argc, argv, "visumd", talk, [&] {
    return programs::convert_scene(from, to, with_plugins({}, plugins), talk.json) ? programs::kPassed
                                                                                   : programs::kFailed;
  });
}

int view_recording(const std::string& file, const recording::PluginFolders& plugins,
                   gateway::DaemonOptions options, bool json) {
  programs::set_verbosity(2);
  gateway::Playback playback(file, plugins);
  options.playback = &playback;
  gateway::Daemon daemon(playback.world(), options);
  const int signal = programs::run_until_signal(daemon, playback.world(), options, json);
  return signal == SIGINT ? programs::kInterrupted : programs::kPassed;
}

int replay(int argc, char** argv) {
  std::string file;
  programs::PluginOptions plugins;
  programs::OutputOptions talk{.verbosity = 1};
  gateway::DaemonOptions of_daemon;
  of_daemon.port = 0;
  programs::HttpArguments http;
  bool view = false;
  CLI::App app{
      "visumd replay: goes through a recording again and compares the state's hash after every tick"};
  app.add_option("recording", file, "an MCAP file that --record wrote")->required()->type_name("FILE.mcap");
  programs::declare_plugins(app, plugins);
  programs::declare_node_timeout(app, plugins);
  app.add_flag("--json", talk.json, "print one line of JSON");
  auto* shown =
      app.add_flag("--view", view, "show it on the page, with a slider for its time, and compare meanwhile");
  auto* of_view = app.add_option_group("With --view");
  programs::declare_doors(*of_view, of_daemon);
  programs::declare_http(*of_view, of_daemon, http);
  for (auto* option : of_view->get_options()) option->needs(shown);
  app.footer(
      "Examples:\n"
      "  visum replay run.mcap\n"
      "  visum replay run.mcap --view      and open the address that it prints\n"
      "  visum replay run.mcap --view --listen 0.0.0.0 --token-file tokens     for others, too\n"
      "Exit codes: 0 the same bits in every tick, 1 the same as far as the file can be read, 2 bad usage, 3 "
      "no "
      "recording\nor the scene in it is wrong, 5 the first tick that differs is shown, 124 a plug-in hangs, "
      "130 interrupted (--view).");
  return programs::run_command(app, argc, argv, "visumd", talk, [&] {
    const programs::NodeWatch watch(plugins.node_timeout());
    if (view) {
      of_daemon.stuck_node = [&watch] { return watch.stuck(); };
      of_daemon.http = http.settled(of_daemon);
      return view_recording(file, plugin::plugin_folders(plugins.folders), of_daemon, talk.json);
    }
    return programs::report_replay(file, plugin::plugin_folders(plugins.folders), talk.json);
  });
}

int export_ports(const std::string& file, const recording::CsvOptions& options, const std::string& to) {
  std::error_code not_there;
  if (std::filesystem::equivalent(file, to, not_there))
    throw std::runtime_error(to + " is the recording itself");
  const recording::NewFile made(to);
  std::ofstream out_file;
  if (!to.empty()) out_file.open(made.path(), std::ios::binary | std::ios::trunc);
  std::ostream& out = to.empty() ? std::cout : out_file;
  if (!out) throw std::runtime_error(to + ": cannot be written");
  const auto result = recording::export_csv(file, options, out);
  if (!out.flush()) throw std::runtime_error((to.empty() ? "standard output" : to) + ": cannot be written");
  made.keep();
  if (result.damage.empty()) return programs::kPassed;
  spdlog::error("{}: {} rows, then it is damaged: {}", file, result.rows, result.damage);
  return programs::kFailed;
}

int export_csv(int argc, char** argv) {
  std::string file, to;
  recording::CsvOptions options;
  programs::OutputOptions talk{.verbosity = 1};
  CLI::App app{"visumd export: the ports of a recording as CSV, a row per tick"};
  app.add_option("recording", file, "an MCAP file that --record wrote")->required()->type_name("FILE.mcap");
  app.add_option("-o,--output", to, "the CSV file; default: standard output")->type_name("FILE.csv");
  app.add_option("-p,--ports", options.ports, "PART, PART/GROUP or PART/PORT; repeatable. Default: all");
  app.add_option("--from", options.from_s, "simulated seconds")->check(CLI::NonNegativeNumber);
  app.add_option("--to", options.to_s, "simulated seconds")->check(CLI::NonNegativeNumber);
  app.add_option("--every", options.every, "ticks between rows")->check(CLI::Range(1, 1'000'000'000));
  app.footer(
      "Example:\n"
      "  visum export run.mcap -o run.csv --ports \"arm/Actual Angle\" --every 10\n"
      "Exit codes: 0 done, 1 the recording is damaged and what can be read of it is written, 2 bad usage,\n"
      "3 no recording.");
  return programs::run_command(app, argc, argv, "visumd", talk,
                               [&] { return export_ports(file, options, to); });
}

}  // namespace

int main(int argc, char** argv) {
  const std::string_view verb = argc > 1 ? argv[1] : "";
  if (verb == "check") return check(argc - 1, argv + 1);
  if (verb == "convert") return convert(argc - 1, argv + 1);
  if (verb == "replay") return replay(argc - 1, argv + 1);
  if (verb == "export") return export_csv(argc - 1, argv + 1);
  const int words = verb == "record" || verb == "rewind" ? 1 : 0;
  Options options;
  CLI::App app{"visumd: holds a physics world and publishes its hardware parts over TCP"};
  declare_world(app, options, verb);
  declare(app, options);
  return programs::run_command(app, argc - words, argv + words, "visumd", options.talk,
                               [&] { return run(options); });
}

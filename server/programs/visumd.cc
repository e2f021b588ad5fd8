// visumd: the daemon that holds a world and publishes its parts, and its verbs check, convert, record,
// replay, rewind and export. This is the one file that includes from all folders of the server.
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "protocol/command_line/fork_server.h"
#include "protocol/command_line/one_of.h"
#include "protocol/command_line/output.h"
#include "protocol/command_line/parse.h"
#include "protocol/config/config.h"
#include "protocol/config/profile.h"
#include "protocol/config/unknown_name.h"
#include "server/cycle/simulation.h"
#include "server/gateway/daemon.h"
#include "server/gateway/log_tap.h"
#include "server/gateway/model_files.h"
#include "server/gateway/playback.h"
#include "server/programs/command_line.h"
#include "server/programs/csv_file.h"
#include "server/programs/drives_file.h"
#include "server/programs/logbook.h"
#include "server/programs/node_watch.h"
#include "server/programs/profile_file.h"
#include "server/programs/program.h"
#include "server/programs/replay_report.h"
#include "server/programs/scene_check.h"
#include "server/programs/scene_convert.h"
#include "server/programs/used_files.h"
#include "server/recording/archive.h"
#include "server/recording/export_csv.h"
#include "server/recording/flight_recorder.h"
#include "server/recording/log_sink.h"
#include "server/recording/recorder.h"
#include "server/recording/replay.h"
#include "server/scene/convert/convert.h"
#include "server/scene/scene.h"

namespace {

using namespace visum;

constexpr const char* kRecordHelp =
    "record every input, the ports of every tick and the state's hash of every 50th, as an MCAP file";
constexpr const char* kParametersHelp =
    "values for the scene's parameters instead of their defaults, as \"{mass: 2, friction: 0.4}\"";

// The folder that a service manager such as systemd sets aside for our files; without one, the working
// directory.
std::string state_folder() {
  const char* folder = std::getenv("STATE_DIRECTORY");
  return folder && *folder ? folder : ".";
}

// The command line of a world that runs: `visumd SCENE`, `record` and `rewind`.
struct Options {
  std::string scene;
  std::string clock;
  double speedup = 0.0;
  std::int64_t seed = -1;
  int threads = 1;
  programs::OutputOptions output;
  std::vector<std::string> buses;
  programs::PluginOptions plugins;
  programs::HttpArguments http;
  std::string record;                  // a file; empty: none
  std::string try_record;              // as `record`, but may fail
  std::string dump = state_folder();   // folder for the ticks before a freeze; or "off"
  std::string files = state_folder();  // folder for named snapshots and recordings that clients ask for
  std::string models;                  // folder of models, scenes and scenarios; empty: the installation's
  std::string rewound;                 // a recording to continue, instead of a scene
  std::string used_files;              // a file for the list of what the scene was read from; empty: none
  std::string profile;                 // a file; empty: nothing is measured
  std::size_t profile_spans = 1'000'000;
  double at_s = std::numeric_limits<double>::infinity();  // from which simulated time of it
  scene::Options of_scene;
  gateway::DaemonOptions of_daemon;
};

scene::Options with_plugins(scene::Options options, const programs::PluginOptions& plugins) {
  options.plugin_folders = plugin::plugin_folders(plugins.folders);
  return options;
}

void set_pace(const Options& options, scene::Scene& scene) {
  if (!options.clock.empty()) scene.clock = scene::clock_of(options.clock);
  if (options.speedup > 0.0) scene.speed = options.speedup;
  for (world::EngineSetting& engine : scene.world.engines) engine.threads = options.threads;
}

scene::Scene load(const Options& options) {
  auto scene = scene::load_any(options.scene, with_plugins(options.of_scene, options.plugins));
  set_pace(options, scene);
  if (options.seed >= 0) scene.seed = static_cast<std::uint64_t>(options.seed);
  for (const auto& loss : scene.losses) spdlog::warn("{}", loss);
  for (const auto& note : scene.notes) spdlog::debug("{}", note);
  return scene;
}

// Makes the world that the daemon runs, from a scene or from a moment of a recording.
recording::Rewound make_world(const Options& options) {
  if (!options.rewound.empty()) {
    std::error_code not_there;
    for (const auto& file : {options.record, options.try_record})
      if (std::filesystem::equivalent(options.rewound, file, not_there))
        throw std::runtime_error(
            "--record " + file +
            " is the recording to continue, and would be overwritten: name another file");
    return recording::rewind(
        options.rewound, options.at_s, [&](scene::Scene& scene) { set_pace(options, scene); },
        plugin::plugin_folders(options.plugins.folders), options.of_scene.engine);
  }
  config::FilesNoted noted;
  auto world = std::make_unique<cycle::Simulation>(load(options));
  return {std::move(world),
          {std::move(noted.files), options.of_scene.engine, options.of_scene.parameters, false,
           scene::with_environment(options.of_scene.packages)}};
}

int run(Options options) {
  gateway::LogTap log_for_clients;  // before any thread that logs, and after it
  options.of_daemon.log = &log_for_clients;
  std::optional<config::Profile> profile;
  if (!options.profile.empty()) options.of_daemon.profile = &profile.emplace(options.profile_spans);
  const programs::NodeWatch watch(options.plugins.node_timeout());
  options.of_daemon.stuck_node = [&watch] { return watch.stuck(); };
  auto [world, origin] = make_world(options);
  auto& simulation = *world;
  if (!options.used_files.empty()) programs::write_used_files(origin.files, options.used_files);
  simulation.set_profile(options.of_daemon.profile);
  std::optional<recording::LogSink> log;
  recording::Archive archive(options.files, origin);
  options.of_daemon.archive = &archive;
  options.of_daemon.models =
      options.models.empty() ? gateway::find_models_folder() : std::filesystem::path(options.models);
  options.of_daemon.scenes = {{}, origin.engine, {}, origin.packages};
  if (options.seed >= 0) options.of_daemon.scenes.seed = static_cast<std::uint64_t>(options.seed);
  std::optional<recording::FlightRecorder> flight;
  if (!options.record.empty() || !options.try_record.empty())
    log.emplace();
  else if (options.dump != "off")
    options.of_daemon.flight = &flight.emplace(simulation, origin, options.dump);
  for (const auto& bus : options.buses)
    options.of_daemon.buses.push_back(bus::parse_bus(bus, simulation.scene()));
  options.of_daemon.http = options.http.settled(options.of_daemon);
  options.of_daemon.paced = options.speedup > 0.0;
  std::function<void(const std::string&)> abandon;  // set once all is there that it needs
  options.of_daemon.abandoned = [&abandon](const std::string& what) { abandon(what); };
  gateway::Daemon daemon(simulation, options.of_daemon);
  std::optional<programs::Logbook> logbook;
  if (log) logbook.emplace(simulation, origin, options.record, options.try_record, *log);
  abandon = [&](const std::string& what) {
    spdlog::error("ended after tick {}; the tick after it was abandoned, as it did not end: {}",
                  simulation.working().border(), what);
    logbook.reset();
    programs::end_at_once(programs::kTimedOut);
  };
  const int signal = programs::run_until_signal(daemon, simulation, options.of_daemon, options.output.json);
  if (simulation.frozen())
    spdlog::error("the world froze at tick {}: {}", simulation.tick_count(), simulation.fault());
  spdlog::info("ended at tick {}", simulation.tick_count());
  const bool recorded = !logbook || logbook->close();
  if (profile) programs::write_profile(*profile, options.profile);
  if (signal == SIGINT) return programs::kInterrupted;
  return simulation.frozen() || !recorded ? programs::kFailed : programs::kPassed;
}

// Adds what the world is made from: a scene, or a recording of one, which also fixes the seed. `verb` is
// "record", "rewind" or empty.
void declare_world(CLI::App& app, Options& options, std::string_view verb) {
  if (verb == "record") {
    app.add_option("recording", options.record, kRecordHelp)->required()->type_name("FILE.mcap");
  } else {
    auto* record = app.add_option("--record", options.record, kRecordHelp)->type_name("FILE.mcap");
    app.add_option("--try-record", options.try_record,
                   "as --record, but a recording that cannot be written is only a warning")
        ->type_name("FILE.mcap")
        ->excludes(record);
  }
  app.add_option("--used-files", options.used_files, "list what the scene was read from: XXH64 and path")
      ->type_name("FILE");
  app.add_option("--dump", options.dump,
                 "folder for the last thousand ticks, written if the world freezes and --record is not "
                 "given; or off. "
                 "Default: $STATE_DIRECTORY, or the working directory")
      ->type_name("FOLDER|off");
  app.add_option("--files", options.files,
                 "folder for the snapshots with names and the recordings that clients ask for. Default: "
                 "$STATE_DIRECTORY, or the working directory")
      ->type_name("FOLDER");
  app.add_option("--models", options.models,
                 "folder of the models that clients may spawn by name, with the scenes that they may load in "
                 "its folder scenes, and the scenarios in scenarios. Default: the installation's models")
      ->type_name("FOLDER")
      ->check(CLI::ExistingDirectory);
  if (verb == "rewind") {
    app.add_option("recording", options.rewound, "the run to continue")->required()->type_name("FILE.mcap");
    app.add_option("--at", options.at_s,
                   "continue from this time, in simulated seconds from the run's beginning; default: its end")
        ->check(CLI::NonNegativeNumber);
    app.add_option("--engine", options.of_scene.engine,
                   "the engine for all bodies from there on, instead of the run's engines");
    return;
  }
  app.add_option("scene", options.scene,
                 "the scene: .yaml, or a model: .urdf, .sdf, .mjcf, .xml, .x3d, .x3dv or .wrl")
      ->required()
      ->type_name("FILE");
  app.add_option("--seed", options.seed, "the seed of the world's random numbers, instead of the scene's")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--engine", options.of_scene.engine, "the engine for all bodies, instead of the scene's");
  app.add_option("--parameters", options.of_scene.parameters, kParametersHelp)->type_name("YAML");
}

constexpr const char* kExitCodes =
    "Exit codes: 0 ended in good order, 1 the world froze or the recording is not whole, 2 bad usage, 3 the "
    "scene is wrong, 124 a plug-in hangs, or a tick did not end within 2 s of the signal and was abandoned, "
    "130 interrupted.";

std::string footer_of(std::string_view verb, const std::string& name) {
  std::string examples = "Example:\n  " + name;
  if (verb == "record") {
    examples += " run.mcap models/scenes/amtec_arm.yaml\n";
  } else if (verb == "rewind") {
    examples =
        "Examples:\n  " + name + " run.mcap --at 12.5\n  " + name + " run.mcap --at 12.5 --engine ode\n";
  } else {
    examples =
        "`visumd check`, `convert`, `drives`, `record`, `replay`, `rewind` and `export` do the same as the "
        "verbs of `visum` with these names.\n\n"
        "Examples:\n"
        "  visumd models/scenes/amtec_arm.yaml\n"
        "  visumd models/scenes/amtec_arm.yaml --clock lockstep --port 0 --json\n"
        "  visumd models/scenes/amtec_arm.yaml --bus arm=pty:arm.tty\n"
        "  visumd models/scenes/amtec_arm.yaml --record run.mcap\n"
        "The first serves the arm in real time on 127.0.0.1:1500. The third also puts its modules on a "
        "serial "
        "line. `visum replay run.mcap` compares the recorded run with a new one.\n";
  }
  return examples + kExitCodes;
}

// Adds the options that `visumd SCENE`, `record` and `rewind` share.
void declare(CLI::App& app, Options& options) {
  programs::declare_common(app, options.of_daemon, options.output);
  programs::declare_http(app, options.of_daemon, options.http);
  app.add_option("--clock", options.clock, "instead of the scene's clock: realtime, lockstep or free")
      ->check(command_line::one_of({scene::kClockNames.begin(), scene::kClockNames.end()}));
  app.add_option("--speedup", options.speedup,
                 "simulated seconds per second of wall time; in lockstep this is the most")
      ->check(CLI::Range(1e-3, 1e3));
  app.add_option("--threads", options.threads, "of the engine `impulse`; any number gives the same bits")
      ->check(CLI::Range(1, world::kMostThreads))
      ->capture_default_str();
  programs::declare_plugins(app, options.plugins);
  programs::declare_packages(app, options.of_scene.packages);
  programs::declare_cache(app);
  programs::declare_node_timeout(app, options.plugins);
  app.add_option("--bus", options.buses,
                 "PART=KIND:WHERE, a field bus to the part's modules; repeatable. KIND:WHERE is pty:PATH, "
                 "tcp:PORT, slcan:PATH or socketcan:INTERFACE; ,baud=N and ,delay_ms=X may follow")
      ->type_name("BUS");
  app.add_option("--profile", options.profile,
                 "measure where the time goes, and write it to this file as a trace that Perfetto opens")
      ->type_name("FILE.json");
  app.add_option("--profile-spans", options.profile_spans,
                 "spans of time to keep for the trace; 0: only the sums")
      ->check(CLI::Range(0, 100'000'000))
      ->capture_default_str();
  app.add_flag("-r,--run", options.of_daemon.run_at_once,
               "let time run at once instead of from the first lease on");
  command_line::add_version(app);
}

int serve(const programs::Command& command, std::string_view verb) {
  Options options;
  CLI::App app{verb == "record"   ? "Runs a scene and records what happens in it"
               : verb == "rewind" ? "Runs a world from a moment of a recording on"
                                  : "Holds a physics world and publishes its hardware parts over TCP",
               command.name};
  declare_world(app, options, verb);
  declare(app, options);
  app.footer(footer_of(verb, command.name));
  return programs::run_command(app, command, "visumd", options.output, [&] { return run(options); });
}

int check(const programs::Command& command) {
  std::string scene;
  programs::PluginOptions plugins;
  scene::Options of_scene;
  programs::OutputOptions output{.verbosity = 1};
  CLI::App app{"Says what is wrong with a scene, where, and what was meant", command.name};
  app.add_option("scene", scene,
                 "the scene: .yaml, or a model: .urdf, .sdf, .mjcf, .xml, .x3d, .x3dv or .wrl")
      ->required()
      ->type_name("FILE");
  app.add_option("--engine", of_scene.engine, "the engine for all bodies, instead of the scene's");
  app.add_option("--parameters", of_scene.parameters, kParametersHelp)->type_name("YAML");
  programs::declare_plugins(app, plugins);
  programs::declare_packages(app, of_scene.packages);
  programs::declare_cache(app);
  programs::declare_node_timeout(app, plugins);
  app.add_flag("--json", output.json, "print one line of JSON");
  app.footer("Example:\n  " + command.name +
             " models/scenes/cart.yaml\n"
             "Exit codes: 0 the scene is right, 2 bad usage, 3 the scene is wrong, 124 a plug-in hangs.");
  return programs::run_command(app, command, "visumd", output, [&] {
    const programs::NodeWatch watch(plugins.node_timeout());
    programs::check_scene(scene, with_plugins(of_scene, plugins), output.json);
    return programs::kPassed;
  });
}

int convert(const programs::Command& command) {
  std::string from, to;
  programs::PluginOptions plugins;
  scene::Options of_scene;
  programs::OutputOptions output{.verbosity = 1};
  CLI::App app{"Writes a scene in another format, and lists what that format cannot hold", command.name};
  app.add_option("FROM", from, "the scene: .yaml, .urdf, .sdf, .mjcf, .xml, .x3d, .x3dv or .wrl")->required();
  app.add_option("TO", to, "the file to write: .yaml, .sdf, .x3d, .x3dv or .wrl")->required();
  programs::declare_plugins(app, plugins);
  programs::declare_packages(app, of_scene.packages);
  programs::declare_cache(app);
  app.add_flag("--json", output.json, "print one line of JSON");
  app.footer(
      "Examples:\n  " + command.name + " models/scenes/hall.yaml hall.x3d\n  " + command.name +
      " hall.x3d hall.yaml\n"
      "Exit codes: 0 everything is written, 1 written without what is listed, 2 bad usage, 3 the scene "
      "is wrong, or what was written cannot be read again.");
  return programs::run_command(app, command, "visumd", output, [&] {
    return programs::convert_scene(from, to, with_plugins(of_scene, plugins), output.json)
               ? programs::kPassed
               : programs::kFailed;
  });
}

// Shows a recording on the page, with another one beside it if there is one, until a signal ends it.
int view_recording(const std::string& file, const std::string& beside,
                   const recording::PluginFolders& plugins, gateway::DaemonOptions options, bool json) {
  programs::set_verbosity(2);  // the page's address is news
  gateway::Playback playback(file, plugins, beside);
  options.playback = &playback;
  gateway::Daemon daemon(playback.world(), options);
  const int signal = programs::run_until_signal(daemon, playback.world(), options, json);
  return signal == SIGINT ? programs::kInterrupted : programs::kPassed;
}

int replay(const programs::Command& command) {
  std::string file, beside;
  programs::PluginOptions plugins;
  programs::OutputOptions output{.verbosity = 1};
  gateway::DaemonOptions of_daemon;
  of_daemon.port = 0;
  programs::HttpArguments http;
  bool view = false;
  CLI::App app{"Repeats a recorded run and compares ports and the state's hash", command.name};
  app.add_option("recording", file, "an MCAP file that --record wrote")->required()->type_name("FILE.mcap");
  programs::declare_plugins(app, plugins);
  programs::declare_cache(app);
  programs::declare_node_timeout(app, plugins);
  app.add_flag("--json", output.json, "print one line of JSON");
  auto* shown =
      app.add_flag("--view", view, "show it on the page, with a slider for its time, and compare meanwhile");
  auto* of_view = app.add_option_group("With --view");
  of_view
      ->add_option("--beside", beside,
                   "a second recording: its bodies as ghosts, its ports as dashed lines, and where the two "
                   "differ, as `visum compare` tells it")
      ->type_name("FILE.mcap");
  programs::declare_doors(*of_view, of_daemon);
  programs::declare_http(*of_view, of_daemon, http);
  for (auto* option : of_view->get_options()) option->needs(shown);
  app.footer("Examples:\n  " + command.name + " run.mcap\n  " + command.name + " run.mcap --view\n  " +
             command.name + " run.mcap --view --beside other.mcap\n  " + command.name +
             " run.mcap --view --listen 0.0.0.0 --token-file tokens\n"
             "With --view, open the address that it prints. The last example also lets others look.\n"
             "Exit codes: 0 the same bits in every tick, 1 the same as far as the file can be read, 2 bad "
             "usage, 3 this is not a recording or the scene in it is wrong, 5 the first tick that differs is "
             "shown, 124 a plug-in hangs, 130 interrupted (--view).");
  return programs::run_command(app, command, "visumd", output, [&] {
    const programs::NodeWatch watch(plugins.node_timeout());
    if (view) {
      of_daemon.stuck_node = [&watch] { return watch.stuck(); };
      of_daemon.http = http.settled(of_daemon);
      return view_recording(file, beside, plugin::plugin_folders(plugins.folders), of_daemon, output.json);
    }
    return programs::report_replay(file, plugin::plugin_folders(plugins.folders), output.json);
  });
}

int export_csv(const programs::Command& command) {
  std::string file, to;
  recording::CsvOptions options;
  programs::OutputOptions output{.verbosity = 1};
  CLI::App app{"Writes the ports of a recording as CSV, one row per tick", command.name};
  app.add_option("recording", file, "an MCAP file that --record wrote")->required()->type_name("FILE.mcap");
  app.add_option("-o,--output", to, "the CSV file; default: standard output")->type_name("FILE.csv");
  app.add_option("-p,--ports", options.ports, "PART, PART/GROUP or PART/PORT; repeatable. Default: all");
  app.add_option("--from", options.from_s, "the first time to write, in simulated seconds")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--to", options.to_s, "the last time to write, in simulated seconds")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--every", options.every, "ticks between rows")->check(CLI::Range(1, 1'000'000'000));
  app.footer("Example:\n  " + command.name +
             " run.mcap -o run.csv --ports \"arm/Actual Angle\" --every 10\n"
             "Exit codes: 0 done, 1 the recording is damaged and what can be read of it is written, 2 bad "
             "usage, 3 this is not a recording.");
  return programs::run_command(app, command, "visumd", output,
                               [&] { return programs::export_ports(file, options, to); });
}

const std::vector<std::string> kVerbs{"check", "convert", "drives", "export", "record", "replay", "rewind"};

// A verb that is misspelt would be taken for a scene. It is one if no such file is there and words follow it.
int refuse_misspelt_verb(int argc, std::string_view word) {
  std::error_code error;
  const bool is_name = argc > 2 && !word.starts_with('-') && word.find_first_of("./") == word.npos;
  if (!is_name || std::filesystem::exists(word, error) || !config::nearest(word, kVerbs)) return 0;
  std::cerr << "visumd: " << config::unknown_name("verb", word, kVerbs) << "\n";
  return programs::kUsage;
}

int act(int argc, char** argv) {
  const std::string verb = argc > 1 ? argv[1] : "";
  const programs::Command of_verb{argc - 1, argv + 1,
                                  command_line::typed_name(argv[0], verb, "visumd " + verb)};
  if (verb == "check") return check(of_verb);
  if (verb == "convert") return convert(of_verb);
  if (verb == "drives") return programs::write_drives(of_verb);
  if (verb == "replay") return replay(of_verb);
  if (verb == "export") return export_csv(of_verb);
  if (verb == "record" || verb == "rewind") return serve(of_verb, verb);
  if (const int code = refuse_misspelt_verb(argc, verb)) return code;
  return serve({argc, argv, "visumd"}, {});
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 || std::string_view(argv[1]) != "fork-server") command_line::leave(act(argc, argv));
  // `visum campaign` starts one world after another by it, without loading visumd again. The reader of YAML
  // makes its tables when it first reads.
  config::load_text("{}", "nothing");
  command_line::leave(command_line::serve_forks(STDIN_FILENO, act));
}

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string_view>
#include <system_error>

#include "clients/visum/campaign/shard.h"
#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/interrupt.h"
#include "clients/visum/common/terminal.h"
#include "clients/visum/common/whole_file.h"
#include "clients/visum/run/daemon.h"
#include "clients/visum/run/event_lines.h"
#include "clients/visum/run/fork_server.h"
#include "clients/visum/run/progress.h"
#include "clients/visum/run/reports.h"
#include "clients/visum/run/run_profile.h"
#include "clients/visum/run/runner.h"
#include "clients/visum/run/scenario_reader.h"
#include "clients/visum/run/spare_recording.h"
#include "clients/visum/run/sweep.h"
#include "clients/visum/run/worker.h"
#include "clients/visum/verbs/campaign_runs.h"
#include "clients/visum/verbs/run_many.h"
#include "clients/visum/verbs/verbs.h"
#include "protocol/command_line/one_of.h"
#include "protocol/config/new_file.h"

namespace visum::cli {
namespace {

class RunVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("SCENARIO", file_, "a scenario's YAML file; needed");
    app.add_option("--junit", junit_, "write a JUnit XML report to this file");
    auto* json = app.add_flag("--json", json_, "print JSON: a line per check, then the result");
    app.add_flag(
           "--events", events_,
           "print what happens as it happens, a line of JSON each: lines of controllers, checks as soon "
           "as they are certain, the end")
        ->excludes(json);
    app.add_option("--engine", engine_, "the engine for all bodies, instead of the scene's");
    app.add_option("--seed", seed_, "the seed of the world's random numbers, instead of the scenario's")
        ->check(CLI::NonNegativeNumber);
    app.add_option("--clock", clock_, "instead of the scenario's clock: realtime, lockstep or free")
        ->check(command_line::one_of({"realtime", "lockstep", "free"}));
    app.add_option("--plugins", plugins_, "a folder to look for the scene's plug-ins in; repeatable")
        ->type_name("FOLDER")
        ->check(CLI::ExistingDirectory);
    app.add_option("--node-timeout", node_timeout_s_,
                   "seconds that one call of a plug-in may take; 0: no limit");
    app.add_flag("--no-cache", no_cache_, "neither use nor keep converted meshes of earlier runs");
    app.add_option("--speedup", speedup_,
                   "simulated seconds per second of wall time; in lockstep this is the most, and without it "
                   "the world runs as "
                   "fast as it can")
        ->check(number_within(1e-3, 1e3));
    app.add_option("--threads", threads_,
                   "threads on which the engine `impulse` solves what does not touch side by side; any "
                   "number gives the same bits")
        ->check(CLI::Range(1, 64))
        ->capture_default_str();
    auto* record = app.add_option(
        "--record", record_,
        "record every input, the ports of every tick and the state's hash of every 50th, as an MCAP file");
    app.add_option("--try-record", try_record_,
                   "as --record, but a recording that cannot be written is only a warning")
        ->type_name("FILE")
        ->excludes(record);
    app.add_option("--recordings", recordings_,
                   "folder for the recording of a run that fails; or off. Default: the folder of --report, "
                   "else that of "
                   "--junit, else the working directory if the environment has CI set, else off")
        ->type_name("FOLDER|off");
    app.add_flag("--all-recordings", keeps_all_,
                 "with --report or --recordings: keep those of runs that pass, too");
    app.add_option("--port", port_, "the daemon's port; 0: any free one")->capture_default_str();
    app.add_option("--timeout", timeout_s_, "give the run up after this many seconds of wall time")
        ->check(number_within(1e-3, 1e7));
    app.add_flag("--progress", progress_, "show time, pace and the controller's last line while it runs");
    app.add_flag("--keep", keep_, "afterwards let the world run on in real time, until Ctrl-C");
    profile_option_ =
        app.add_option("--profile", profile_,
                       "print where the wall time of the run went; with a file, also write a trace that "
                       "Perfetto opens (ui.perfetto.dev)")
            ->expected(0, 1)
            ->type_name("[FILE.json]");
    declare_runs(app);
    app.footer(
        "Starts visumd on a free port and the scenario's controllers, lets time run, checks, and ends them "
        "all. "
        "With --record, `visum replay` can repeat the run.\n"
        "Exit codes: 0 passed, 1 a check failed, 2 bad usage, 3 the scene or scenario is wrong, 4 a "
        "controller was "
        "lost or timed out, 6 what the run claims could not be established (the host was too slow for real "
        "time, a program was not in step, a controller exchanged nothing), 124 the wall time was over "
        "or a plug-in hangs, 130 interrupted.\n\nExamples:\n"
        "  visum run models/scenarios/pick_and_place.yaml\n"
        "  visum run models/scenarios/pick_and_place.yaml --junit report.xml --json\n"
        "  visum run models/scenarios/pick_and_place.yaml --record run.mcap\n"
        "  visum run models/scenarios/pick_and_place_sweep.yaml --jobs 2 --report failures");
  }

  int run() override {
    settle_words();
    const config::Node root = config::load_file(file_);
    if (shard_option_->count() > 0) return run_shard(root);
    const run::Sweep sweep = sweep_of(root);
    if (worker_) return work_off(root, sweep);
    if (!values_.empty() && !report_.empty())
      throw ExitError(kUsage, "--report is about all runs, --values about one: give one of the two");
    if (!values_.empty()) return run_one(read(root, sweep));
    if (only_ > sweep.runs())
      throw ExitError(kUsage, "--only: the scenario has " + std::to_string(sweep.runs()) +
                                  (sweep.runs() == 1 ? " run" : " runs"));
    if (only_ == 0 && (sweep.given() || !report_.empty())) return run_all(root);
    if (!report_.empty())
      throw ExitError(kUsage, "--report is about all runs, --only about one: give one of the two");
    return run_one(read(root, sweep));
  }

 private:
  // The options of sweeps and campaigns.
  void declare_runs(CLI::App& app) {
    app.add_option("--jobs,-j", jobs_, "runs of a sweep at a time; 0: as many as there are processors")
        ->capture_default_str()
        ->check(CLI::Range(0, 1000));
    app.add_option("--only", only_, "do only this run of a sweep, counted from 1")
        ->check(CLI::PositiveNumber);
    app.add_option(
           "--values", values_,
           "do only the run at these values of the sweep, as \"{mass: 0.3, friction: 0.5}\"; --only then "
           "is just its name")
        ->type_name("YAML");
    shard_option_ =
        app.add_option("--shard", shard_,
                       "do only share I of N of a campaign's runs, for --report; without a value, "
                       "I/N is that of the cluster's task: see CAMPAIGNS.md")
            ->expected(0, 1)
            ->type_name("[I/N]");
    app.add_option("--report", report_,
                   "write report.html, junit.xml and a recording of each run that fails to this folder")
        ->type_name("FOLDER");
    app.add_flag("--worker", worker_, "make the runs that standard input asks for")->group("");
    app.add_option("--result", result_, "write the whole result as JSON, with each check's values over time")
        ->type_name("FILE");
  }

  // A word behind --profile is its file, or the scenario if no other word is that.
  void settle_words() {
    if (file_.empty()) file_.swap(profile_);
    if (file_.empty()) throw ExitError(kUsage, "SCENARIO is required: a scenario's YAML file");
    const auto extension = std::filesystem::path(profile_).extension();
    if (extension == ".yaml" || extension == ".yml")
      throw ExitError(kUsage, "--profile " + profile_ + ": that would overwrite a YAML file");
  }

  static run::Sweep sweep_of(const config::Node& root) {
    if (root.kind() != config::Node::Kind::kMap) root.fail("a scenario is a map");
    return run::Sweep(root);
  }

  // Refuses options that are for one run; returns those that each of many runs gets.
  std::vector<std::string> words_of_each() const {
    if (!record_.empty() || !try_record_.empty() || !result_.empty() || keep_ || progress_ || port_ != 0 ||
        profile_option_->count() > 0)
      throw ExitError(
          kUsage,
          "--record, --result, --port, --progress, --profile and --keep are for one run: choose it with "
          "--only, or leave them "
          "out; --report records the runs that fail");
    std::vector<std::string> words;
    if (!engine_.empty()) words.insert(words.end(), {"--engine", engine_});
    if (!clock_.empty()) words.insert(words.end(), {"--clock", clock_});
    if (seed_) words.insert(words.end(), {"--seed", std::to_string(*seed_)});
    if (timeout_s_ > 0.0) words.insert(words.end(), {"--timeout", exact(timeout_s_)});
    if (no_cache_) words.push_back("--no-cache");
    if (threads_ > 1) words.insert(words.end(), {"--threads", std::to_string(threads_)});
    if (speedup_ > 0.0) words.insert(words.end(), {"--speedup", exact(speedup_)});
    for (const auto& folder : plugins_) words.insert(words.end(), {"--plugins", folder});
    if (node_timeout_s_) words.insert(words.end(), {"--node-timeout", exact(*node_timeout_s_)});
    return words;
  }

  int run_all(const config::Node& root) const {
    return run_many(
        {file_, report_, junit_, recordings_folder(), keeps_all_, words_of_each(), jobs_, json_, events_},
        root);
  }

  int run_shard(const config::Node& root) const {
    if (report_.empty()) throw ExitError(kUsage, "--shard needs --report FOLDER, for the results");
    if (only_ != 0 || !values_.empty() || events_ || !junit_.empty())
      throw ExitError(kUsage, "--only, --values, --events and --junit are not for --shard");
    if (root.kind() != config::Node::Kind::kMap) root.fail("a scenario is a map");
    const auto shard = shard_.empty()
                           ? campaign::shard_from([](const char* name) { return std::getenv(name); })
                           : campaign::shard_of(shard_);
    return run_campaign(
        {file_, report_, words_of_each(), shard, jobs_, json_, false, recordings_ != "off", keeps_all_},
        root);
  }

  // The runs that standard input asks for (run/worker.h).
  int work_off(const config::Node& root, const run::Sweep& sweep) {
    catch_interrupts();
    run::ForkServer forks;
    run::RunOptions options = options_of_run();
    options.forks = &forks;
    options.notes_files = true;
    options.on_line = [](const std::string&, const std::string&) {};
    for (std::string line; !interrupted() && std::getline(std::cin, line);) {
      const auto task = run::read_task(line);
      only_ = task.run;
      values_ = task.values;
      try_record_ = task.recording;
      write_whole_file(task.result, run::report_as_json(make(root, sweep, options)));
      std::puts("done");
      std::fflush(stdout);
    }
    return interrupted() ? kInterrupted : kDone;
  }

  run::Report make(const config::Node& root, const run::Sweep& sweep, const run::RunOptions& options) const {
    run::Report report;
    report.name = report.file = file_;
    report.run = only_;
    try {
      return run::run_scenario(read(root, sweep), options);
    } catch (const ExitError& error) {
      report.code = error.code();
      report.error = error.what();
    } catch (const config::ConfigError& error) {
      report.code = kBadConfig;
      report.error = error.what();
    }
    return report;
  }

  run::RunOptions options_of_run() const {
    run::RunOptions options;
    options.visumd = run::find_visumd();
    options.plugins = plugins_;
    options.node_timeout_s = node_timeout_s_;
    options.caches = !no_cache_;
    options.threads = threads_;
    return options;
  }

  int run_one(run::Scenario scenario) {
    check_writable(junit_);
    check_writable(result_);
    check_writable(profile_);
    record_in_case(scenario);
    catch_interrupts();
    run::Progress progress(progress_, for_people());
    run::RunOptions options = options_of_run();
    options.port = port_;
    options.keep = keep_;
    options.notes_files = !result_.empty();
    options.on_line = [&](const std::string& who, const std::string& line) {
      events_ ? run::EventLines::line(who, line) : progress.line(who, line);
    };
    if (events_) {
      options.on_check = &run::EventLines::check;
      run::EventLines::begin(scenario.name, 1, scenario.checks.size());
    }
    options.on_step = [&](double sim_s) { progress.step(sim_s); };
    options.on_keep = [&](const run::Report& report, std::uint16_t port, const run::Catalogue& catalogue) {
      progress.finish();
      tell(report);
      invite(port, catalogue);
    };
    std::optional<run::RunProfile> profile;
    if (profile_option_->count() > 0) options.profile = &profile.emplace(profile_);
    const run::Report report = run::run_scenario(scenario, options);
    const std::string table = profile ? profile->finish() : std::string();
    progress.finish();
    if (!told_) tell(report);
    std::fputs(table.c_str(), for_people());
    spare_.reset();
    return report.code == kDone && !written_ ? kFailed : report.code;
  }

  // The folder for recordings of runs that fail, if the scenario names no file; empty: none.
  std::filesystem::path recordings_folder() const {
    if (recordings_ == "off") return {};
    if (!recordings_.empty()) return recordings_;
    if (!report_.empty()) return report_;
    if (!junit_.empty()) return std::filesystem::absolute(junit_).parent_path();
    const char* ci = std::getenv("CI");
    const std::string_view word = ci ? ci : "";
    return word.empty() || word == "false" || word == "0" ? std::filesystem::path()
                                                          : std::filesystem::current_path();
  }

  // Records the run for the case that it fails. The recording goes away if it passes.
  void record_in_case(run::Scenario& scenario) {
    const auto folder = recordings_folder();
    if (!scenario.record.empty() || folder.empty()) return;
    const auto run = only_ == 0 ? std::string() : "_run_" + std::to_string(only_);
    std::string name = scenario.name;
    std::ranges::replace(name, '/', '_');
    try {
      std::filesystem::create_directories(folder);
      const auto wanted = config::name_beside(folder / name, run + ".mcap");
      scenario.record = spare_.emplace(wanted).path().string();
      scenario.record_if_possible = true;
    } catch (const std::system_error& error) {
      std::fprintf(stderr, "visum: if this run fails, it leaves no recording: %s\n", error.what());
    }
  }

  run::Scenario read(const config::Node& root, const run::Sweep& sweep) const {
    run::Scenario scenario =
        values_.empty()
            ? run::read_scenario(root, std::max<std::size_t>(only_, 1))
            : run::read_scenario(root, sweep.point_of(config::load_text(values_, "--values")), only_);
    if (!engine_.empty()) scenario.engine = engine_;
    if (!clock_.empty()) scenario.clock = clock_;
    if (speedup_ > 0.0) scenario.speedup = speedup_;
    if (seed_) scenario.seed = seed_;
    if (!record_.empty()) scenario.record = record_;
    if (!try_record_.empty()) {
      scenario.record = try_record_;
      scenario.record_if_possible = true;
    }
    if (timeout_s_ > 0.0) scenario.max_wall_s = timeout_s_;
    return scenario;
  }

  // Standard output, where no program reads it.
  std::FILE* for_people() const { return json_ || events_ ? stderr : stdout; }

  void tell(run::Report report) {
    told_ = true;
    if (spare_) report.recording = report.passed() && !keeps_all_ ? std::string() : spare_->keep().string();
    std::fputs(run::report_text(report, Style(for_people())).c_str(), for_people());
    const bool junit = write(junit_, run::report_junit(report));
    written_ = write(result_, run::report_as_json(report)) && junit;
    if (json_) std::printf("%s%s\n", run::checks_json(report).c_str(), run::report_json(report).c_str());
    if (events_) run::EventLines::end(report);
    std::fflush(stdout);
  }

  static bool write(const std::string& file, const std::string& text) {
    if (file.empty()) return true;
    try {
      write_whole_file(file, text);
      return true;
    } catch (const std::runtime_error& error) {
      std::fprintf(stderr, "visum: %s\n", error.what());
      return false;
    }
  }

  void invite(std::uint16_t port, const run::Catalogue& catalogue) const {
    const std::string connect = " --connect 127.0.0.1:" + std::to_string(port);
    std::fprintf(stderr,
                 "The world goes on in real time. Look at it from another terminal; end it with Ctrl-C:\n");
    std::fprintf(stderr, "  visum status%s\n", connect.c_str());
    for (const auto& [part, description] : catalogue.parts) {
      std::fprintf(stderr, "  visum watch %s%s\n", part.c_str(), connect.c_str());
    }
  }

  std::string file_, junit_, engine_, clock_, record_, try_record_, recordings_, report_, result_;
  std::string profile_;  // a file; may be empty
  std::string values_;
  std::string shard_;
  CLI::Option *profile_option_ = nullptr, *shard_option_ = nullptr;
  std::size_t jobs_ = 1, only_ = 0;
  bool json_ = false, events_ = false, progress_ = false, keep_ = false, told_ = false, written_ = false,
       keeps_all_ = false;
  bool worker_ = false;
  std::optional<run::SpareRecording> spare_;
  std::vector<std::string> plugins_;
  std::optional<double> node_timeout_s_;
  bool no_cache_ = false;
  std::optional<std::int64_t> seed_;
  std::uint16_t port_ = 0;
  int threads_ = 1;
  double timeout_s_ = 0.0, speedup_ = 0.0;
};

}  // namespace

std::unique_ptr<Verb> make_run() {
  return std::make_unique<RunVerb>();
}

}  // namespace visum::cli

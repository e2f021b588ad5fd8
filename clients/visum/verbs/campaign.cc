#include <CLI/Validators.hpp>
#include <optional>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/verbs/campaign_runs.h"
#include "clients/visum/verbs/verbs.h"
#include "protocol/command_line/one_of.h"

namespace visum::cli {
namespace {

class CampaignVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("SCENARIO", words_.file, "a scenario's YAML file, usually with `sweep:`")->required();
    app.add_option("--report", words_.folder, "the folder for results and reports; needed")
        ->required()
        ->type_name("FOLDER");
    app.add_option(
           "--jobs,-j", words_.jobs,
           "runs at a time; 0: as many as there are processors. With --on shell: commands at a time; 0: all")
        ->capture_default_str()
        ->check(CLI::Range(0, 1000));
    app.add_flag("--json", words_.json, "print the result as a line of JSON");
    app.add_flag("--fresh", words_.fresh, "make all runs anew, also those whose results are there");
    app.add_flag("!--no-recordings", words_.records, "keep no recordings of runs that fail");
    app.add_flag("--all-recordings", words_.records_all, "keep the recordings of all runs");
    app.add_option("--engine", engine_, "the engine for all bodies, instead of the scene's");
    app.add_flag("--no-cache", no_cache_, "neither use nor keep converted meshes of earlier runs");
    app.add_option(
           "--on", on_,
           "make the runs elsewhere: as an array job of slurm, or by a command of the shell. All machines "
           "must see the same files")
        ->check(command_line::one_of({"slurm", "shell"}));
    app.add_option("--shards", remote_.shards, "with --on: how many shares the runs are in, each one task")
        ->check(CLI::Range(1, 100'000));
    app.add_option("--command", remote_.command,
                   "with --on shell: the command of a shard; {command}, {shard} and {shards} are filled in")
        ->type_name("TEXT");
    app.add_option("--sbatch", remote_.sbatch,
                   "with --on slurm: an option for sbatch, as --sbatch=--time=60; repeatable")
        ->type_name("WORD");
    app.add_option("--tries", remote_.tries, "with --on: how often a shard that did not end well is started")
        ->capture_default_str()
        ->check(CLI::Range(1, 100));
    app.add_option("--timeout", remote_.timeout_s, "with --on: give up after this many seconds")
        ->capture_default_str()
        ->check(number_within(1e-3, 1e7));
    app.footer(
        "Makes all runs of a scenario's sweep and judges them together. The folder gets results.sqlite, "
        "results.csv, summary.json, report.html, and a recording of each run that fails. Called again, it "
        "goes "
        "on where it ended, and makes only runs anew whose scene, scenario or programs have changed.\n"
        "With `search:` in the scenario, further runs look for what breaks a check, or comes nearest to it; "
        "the "
        "worst case becomes worst.yaml and worst.mcap.\n"
        "With `decide:` in the scenario, runs are read in their order by a sequential test, and the campaign "
        "ends once that decides.\n"
        "Exit codes: 0 accepted, 1 rejected, 6 undecided; without `decide:` 1 if any run failed, else 6 if "
        "any is "
        "invalid, else 0. 2 bad usage, 3 the scenario is wrong, 130 interrupted.\n\nExamples:\n"
        "  visum campaign models/scenarios/pick_and_place_sweep.yaml --report results --jobs 0\n"
        "  visum campaign payloads.yaml --report results --json\n"
        "  visum campaign payloads.yaml --report results --on slurm --shards 50\n"
        "  visum campaign payloads.yaml --report results --on shell --shards 4 --jobs 4 \\\n"
        "    --command 'ssh node{shard} {command}'");
  }

  int run() override {
    if (words_.records_all && !words_.records)
      throw ExitError(kUsage, "--all-recordings and --no-recordings exclude each other");
    const config::Node root = config::load_file(words_.file);
    if (root.kind() != config::Node::Kind::kMap) root.fail("a scenario is a map");
    if (!engine_.empty()) words_.words = {"--engine", engine_};
    if (no_cache_) words_.words.push_back("--no-cache");
    return on_.empty() ? run_here(root) : run_elsewhere(root);
  }

 private:
  int run_here(const config::Node& root) const {
    if (remote_.shards != 0 || !remote_.command.empty() || !remote_.sbatch.empty())
      throw ExitError(kUsage, "--shards, --command and --sbatch need --on");
    return run_campaign(words_, root);
  }

  int run_elsewhere(const config::Node& root) {
    if (remote_.shards == 0) throw ExitError(kUsage, "--on needs --shards N");
    if (on_ == "shell" && remote_.command.find("{command}") == std::string::npos)
      throw ExitError(kUsage, "--on shell needs --command with {command} in it");
    if (on_ == "slurm" ? !remote_.command.empty() : !remote_.sbatch.empty())
      throw ExitError(kUsage, "--command is for --on shell, --sbatch for --on slurm");
    if (words_.fresh) throw ExitError(kUsage, "--fresh is not for --on: name another folder");
    remote_.file = words_.file;
    remote_.folder = words_.folder;
    remote_.words = words_.words;
    if (words_.records_all) remote_.words.push_back("--all-recordings");
    if (!words_.records) remote_.words.insert(remote_.words.end(), {"--recordings", "off"});
    // On the shell, --jobs counts commands; each makes one run at a time. A task of Slurm does so, too.
    remote_.at_once = words_.jobs != 0 ? words_.jobs : remote_.shards;
    return run_campaign_elsewhere(on_, remote_, words_, root);
  }

  std::string on_;
  campaign::RemoteOptions remote_{.shards = 0};
  CampaignWords words_{{}, {}, {}, {}, 0};
  std::string engine_;
  bool no_cache_ = false;
};

}  // namespace

std::unique_ptr<Verb> make_campaign() {
  return std::make_unique<CampaignVerb>();
}

}  // namespace visum::cli

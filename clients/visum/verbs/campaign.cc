#include <CLI/Validators.hpp>
#include <optional>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/verbs/campaign_runs.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

class CampaignVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("SCENARIO", words_.file, "a scenario's YAML file, usually with `sweep:`")->required();
    app.add_option("--report", words_.folder, "the folder for results and reports; needed")
        ->required()
        ->type_name("FOLDER");
    app.add_option("--jobs,-j", words_.jobs, "runs at a time; 0: as many as there are processors")
        ->capture_default_str()
        ->check(CLI::Range(0, 1000));
    app.add_flag("--json", words_.json, "print the result as a line of JSON");
    app.add_flag("--fresh", words_.fresh, "make all runs anew, also those whose results are there");
    app.add_flag("!--no-recordings", words_.records, "keep no recordings of runs that fail");
    app.add_option("--engine", engine_, "the engine for all bodies, instead of the scene's");
    app.footer(
        "Makes all runs of a scenario's sweep and judges them together. The folder gets results.sqlite, "
        "results.csv, summary.json, report.html, and a recording of each run that fails. Called again, it "
        "goes "
        "on where it ended, and makes only runs anew whose scene, scenario or programs have changed.\n"
        "With `decide:` in the scenario, runs are read in their order by a sequential test, and the campaign "
        "ends once that decides.\n"
        "Exit codes: 0 accepted, 1 rejected, 6 undecided; without `decide:` 1 if any run failed, else 6 if "
        "any is "
        "invalid, else 0. 2 bad usage, 3 the scenario is wrong, 130 interrupted.\n\nExamples:\n"
        "  visum campaign models/scenarios/pick_and_place_sweep.yaml --report results --jobs 0\n"
        "  visum campaign payloads.yaml --report results --json");
  }

  int run() override {
    const config::Node root = config::load_file(words_.file);
    if (root.kind() != config::Node::Kind::kMap) root.fail("a scenario is a map");
    if (!engine_.empty()) words_.words = {"--engine", engine_};
    return run_campaign(words_, root);
  }

 private:
  CampaignWords words_{{}, {}, {}, {}, 0};
  std::string engine_;
};

}  // namespace

std::unique_ptr<Verb> make_campaign() {
  return std::make_unique<CampaignVerb>();
}

}  // namespace visum::cli

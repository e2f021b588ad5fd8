#include <cstdio>

#include "clients/visum/campaign/merge.h"
#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

void write_runs(JsonWriter& json, const char* name, const std::vector<std::size_t>& runs) {
  json.key(name).begin_array();
  for (const std::size_t run : runs) json.value(run);
  json.end_array();
}

void tell(const char* what, const std::vector<std::size_t>& runs) {
  if (runs.empty()) return;
  std::fprintf(stderr, "visum: %s:", what);
  for (const std::size_t run : runs) std::fprintf(stderr, " %zu", run);
  std::fputs(runs.size() == campaign::Results::kMostListed ? " and perhaps more\n" : "\n", stderr);
}

class ReportVerb : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.require_subcommand(1);
    auto* merge = app.add_subcommand("merge", "put the results of shards together");
    merge->add_option("FOLDER", folders_, "folders of `visum run --shard I/N --report FOLDER`")->required();
    merge->add_option("-o,--output", out_, "the folder for the whole; needed")
        ->required()
        ->type_name("FOLDER");
    merge->add_flag("--json", json_, "print the result as a line of JSON");
    app.footer(
        "Refuses (exit code 1) where a run is missing or doubled, or where results are of another sweep or "
        "another "
        "build, and says which; then it writes nothing.\n\nExamples:\n"
        "  visum report merge shard_1 shard_2 shard_3 -o whole\n"
        "  visum report merge shards/* -o whole --json");
  }

  int run() override {
    const auto merged = campaign::merge({folders_.begin(), folders_.end()}, out_);
    tell("missing runs", merged.missing);
    tell("runs that are there twice", merged.doubled);
    for (const auto& foreign : merged.foreign) std::fprintf(stderr, "visum: %s\n", foreign.c_str());
    if (merged.good()) std::fputs(campaign::summary_text(merged.summary).c_str(), json_ ? stderr : stdout);
    if (json_) print_json(merged);
    return merged.good() ? kDone : kFailed;
  }

 private:
  static void print_json(const campaign::Merged& merged) {
    JsonWriter json;
    json.begin_object().member("runs", merged.runs);
    write_runs(json, "missing", merged.missing);
    write_runs(json, "doubled", merged.doubled);
    json.key("foreign").begin_array();
    for (const auto& foreign : merged.foreign) json.value(foreign);
    json.end_array().member("hash", hex(merged.summary.hash));
    std::printf("%s\n", json.end_object().text().c_str());
  }

  std::vector<std::string> folders_;
  std::string out_;
  bool json_ = false;
};

}  // namespace

std::unique_ptr<Verb> make_report() {
  return std::make_unique<ReportVerb>();
}

}  // namespace visum::cli

#include "clients/visum/campaign/keeper.h"

#include <unistd.h>

#include <utility>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/run/scenario_reader.h"

namespace visum::campaign {
namespace {

std::string host_name() {
  char name[256] = "";
  ::gethostname(name, sizeof name - 1);
  return name;
}

// Why a run failed, on one line.
std::string trouble_of(const run::Report& report) {
  std::string text = report.error.substr(0, report.error.find('\n'));
  const auto add = [&](const std::string& one) { text += (text.empty() ? "" : "; ") + one; };
  for (const auto& failure : report.failures) add(failure);
  for (const auto& check : report.checks)
    if (!check.passed && report.error.empty()) add(check.name);
  return text;
}

}  // namespace

std::string as_json(const run::SweepPoint& point) {
  cli::JsonWriter json;
  json.begin_object();
  for (const auto& [name, value] : point.described) json.member(name, value);
  return json.end_object().text();
}

Keeper::Keeper(const config::Node& root, KeeperOptions options, Results& results)
    : root_(root),
      options_(std::move(options)),
      results_(results),
      keys_(root, options_.words, results.identity().build),
      host_(host_name()) {}

std::optional<Row> Keeper::find(std::size_t run, const run::SweepPoint& point) {
  const auto scenario = run::read_scenario(root_, point, run);
  const std::string key = keys_.key(scenario, point.variables);
  auto known = reusable(scenario, run, key, as_json(point));
  if (!known) keys_of_[run] = key;
  return known;
}

std::optional<Row> Keeper::reusable(const run::Scenario& scenario, std::size_t run, const std::string& key,
                                    const std::string& parameters) {
  if (options_.fresh) return std::nullopt;
  auto row = results_.find(run);
  const bool ours = row && row->key == key;
  if (!ours) row = results_.find_earlier(key);
  if (!row || !row->reusable || row->files == 0 || !scenario.record.empty()) return std::nullopt;
  if (!keys_.find_change(results_.files(row->files)).empty()) return std::nullopt;
  std::error_code none;
  if (options_.records && (options_.records_all || row->code != cli::kDone) &&
      (row->recording.empty() || !std::filesystem::exists(options_.folder / row->recording, none)))
    return std::nullopt;
  if (!ours) results_.adopt(*row, run, parameters);
  return row;
}

Row Keeper::keep(std::size_t run, const run::SweepPoint& point, const run::Report& report) {
  Row row;
  row.run = run;
  row.parameters = as_json(point);
  row.code = report.code;
  row.error = trouble_of(report);
  row.state_hash = report.state_hash;
  row.ticks = report.ticks;
  row.sim_seconds = report.sim_seconds;
  row.key = std::exchange(keys_of_[run], {});
  row.reusable = report.clock == "lockstep" && (report.code == cli::kDone || report.code == cli::kFailed) &&
                 !report.files.empty();
  if (!report.recording.empty()) row.recording = std::filesystem::path(report.recording).filename().string();
  keys_of_.erase(run);
  results_.add(row, report, host_);
  return row;
}

}  // namespace visum::campaign

#include "clients/visum/run/report_many.h"

#include <algorithm>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"

namespace visum::run {
namespace {

std::size_t failed(std::span<const Report> reports) {
  return static_cast<std::size_t>(
      std::ranges::count_if(reports, [](const Report& one) { return !one.passed(); }));
}

std::string reasons(const Report& report, const cli::Style& style) {
  std::string text;
  const auto add = [&](const char* word, const std::string& reason) {
    text += "    " + style.red(word) + "  " + reason + "\n";
  };
  if (!report.error.empty()) add("ERROR ", report.error);
  for (const auto& failure : report.failures) add("FAILED", failure);
  for (const auto& check : report.checks)
    if (!check.passed && (check.value || report.error.empty()))
      add("FAILED", check.name + ": " + check.failure);
  return text;
}

}  // namespace

std::string run_line(const Report& report, const cli::Style& style) {
  const auto good = std::ranges::count_if(report.checks, &CheckResult::passed);
  std::string line = (report.passed() ? style.green("passed") : style.red("FAILED")) + "  run " +
                     std::to_string(std::max<std::size_t>(report.run, 1));
  if (!report.swept.empty()) line += ": " + swept_text(report);
  line += "  " + std::to_string(good) + " of " + std::to_string(report.checks.size()) + " checks, " +
          cli::hex(report.state_hash) + "\n";
  return line + reasons(report, style);
}

std::string many_text(std::span<const Report> reports, double wall_seconds, const cli::Style& style) {
  const std::size_t bad = failed(reports);
  return (bad == 0 ? style.green("PASSED") : style.red("FAILED")) + ": " +
         std::to_string(reports.size() - bad) + " of " + std::to_string(reports.size()) + " runs in " +
         cli::fixed(wall_seconds, 1) + " s\n";
}

std::string run_json(const Report& report) {
  cli::JsonWriter json;
  json.begin_object().member("run", std::max<std::size_t>(report.run, 1)).key("sweep").begin_object();
  for (const auto& [name, value] : report.swept) json.member(name, value);
  json.end_object().member("passed", report.passed()).member("code", static_cast<int>(report.code));
  json.member("ticks", report.ticks).member("sim_seconds", report.sim_seconds);
  json.member("wall_seconds", report.wall_seconds).member("state_hash", cli::hex(report.state_hash));
  return json.end_object().text();
}

std::string many_json(std::span<const Report> reports, double wall_seconds) {
  const std::size_t bad = failed(reports);
  cli::JsonWriter json;
  json.begin_object().member("passed", bad == 0).member("runs", reports.size()).member("failed", bad);
  return json.member("wall_seconds", wall_seconds).end_object().text();
}

}  // namespace visum::run

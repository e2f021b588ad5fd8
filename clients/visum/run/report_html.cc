#include "clients/visum/run/reports.h"

#include <algorithm>
#include <set>
#include <vector>

#include "clients/visum/common/format.h"
#include "clients/visum/common/markup.h"
#include "clients/visum/common/shell_word.h"
#include "clients/visum/common/terminal.h"
#include "clients/visum/run/plot.h"
#include "clients/visum/run/sweep_figures.h"

namespace visum::run {
namespace {

using cli::markup;
using cli::shell_word;

constexpr const char* kStyle = R"(
:root{color-scheme:light dark;--line:#8886;--good:#1a7f37;--bad:#cf222e;--course:#0969da}
@media(prefers-color-scheme:dark){:root{--good:#3fb950;--bad:#f85149;--course:#58a6ff}}
body{font:15px/1.45 system-ui,sans-serif;max-width:1100px;margin:2em auto;padding:0 1em}
h1{margin-bottom:.2em}h2{margin-top:2em;border-top:1px solid var(--line);padding-top:1em}
table{border-collapse:collapse;margin:1em 0;display:block;overflow-x:auto}
th,td{text-align:left;padding:.25em .7em;border-bottom:1px solid var(--line);vertical-align:top}
td.n{text-align:right;font-variant-numeric:tabular-nums}code,pre,td.h{font-family:ui-monospace,monospace;font-size:13px}
pre{padding:.7em;border:1px solid var(--line);overflow-x:auto}.good{color:var(--good)}.bad{color:var(--bad)}
svg{max-width:720px;width:100%;display:block}svg text{font-size:11px;fill:currentColor}
.course{fill:var(--course);fill-opacity:.25;stroke:var(--course);stroke-width:1.3;stroke-linejoin:round}
.limit{stroke:var(--bad);stroke-dasharray:5 4}.worst{fill:var(--bad)}summary{cursor:pointer;padding:.2em 0}
)";

std::string cell(const std::string& text, const char* kind = "") {
  return std::string("<td") + (*kind ? std::string(" class=\"") + kind + "\"" : "") + ">" + markup(text) +
         "</td>";
}

std::string number(const Report& report) {
  return std::to_string(std::max<std::size_t>(report.run, 1));
}

std::string verdict(bool passed) {
  return passed ? "<td class=\"good\">passed</td>" : "<td class=\"bad\">FAILED</td>";
}

std::string heading(const Report& report) {
  return "Run " + number(report) + (report.swept.empty() ? "" : ": " + swept_text(report));
}

// The failure in one line for the table: the names of checks, or why there are no results.
std::string what_failed(const Report& report) {
  if (!report.error.empty()) return report.error.substr(0, report.error.find('\n'));
  std::string text;
  const auto add = [&](const std::string& one) { text += (text.empty() ? "" : "; ") + one; };
  for (const auto& failure : report.failures) add(failure);
  for (const auto& check : report.checks)
    if (!check.passed) add(check.name);
  return text;
}

std::string checks_passed(const Report& report) {
  const auto passed = std::ranges::count_if(report.checks, &CheckResult::passed);
  return std::to_string(passed) + " of " + std::to_string(report.checks.size());
}

std::string table_row(const Report& report, const std::vector<std::string>& names) {
  std::string row =
      "<tr><td class=\"n\"><a href=\"#run" + number(report) + "\">" + number(report) + "</a></td>";
  for (const auto& name : names) {
    const auto value = std::ranges::find(report.swept, name, &std::pair<std::string, std::string>::first);
    row += cell(value == report.swept.end() ? "" : value->second);
  }
  return row + verdict(report.passed()) + cell(checks_passed(report)) + cell(what_failed(report)) +
         cell(cli::fixed(report.sim_seconds, 3), "n") + cell(cli::fixed(report.wall_seconds, 3), "n") +
         cell(cli::hex(report.state_hash), "h") + "</tr>\n";
}

std::string table_of(const std::vector<const Report*>& reports) {
  std::vector<std::string> names;
  for (const Report* report : reports)
    if (names.empty())
      for (const auto& [name, value] : report->swept) names.push_back(name);
  std::string table = "<table><thead><tr><th>run</th>";
  for (const auto& name : names) table += "<th>" + markup(name) + "</th>";
  table +=
      "<th>result</th><th>checks</th><th>what failed</th><th>simulated s</th><th>wall s</th><th>state "
      "hash</th></tr></thead><tbody>\n";
  for (const Report* report : reports) table += table_row(*report, names);
  return table + "</tbody></table>\n";
}

std::string measured_value(const CheckResult& check) {
  if (!check.value) return "never looked at";
  return value_text(check, 6) + " at " + cli::fixed(check.at_s, 3) + " s";
}

std::string checks_of(const Report& report) {
  if (report.checks.empty()) return {};
  std::string text =
      "<table><thead><tr><th></th><th>check</th><th>of</th><th>is</th><th>must be</th></tr></thead>";
  for (const auto& check : report.checks)
    text += "<tr>" + verdict(check.passed) + cell(check.name) + cell(check.text) +
            cell(measured_value(check)) + cell(check.bound) + "</tr>\n";
  text += "</table>\n";
  for (const auto& check : report.checks)
    if (!check.passed)
      if (const std::string picture = plot(check); !picture.empty())
        text += "<p>" + markup(check.failure) + "</p>" + picture;
  return text;
}

std::string troubles_of(const Report& report) {
  std::string text;
  if (!report.error.empty()) text += "<pre class=\"bad\">" + markup(report.error) + "</pre>\n";
  for (const auto& failure : report.failures) text += "<p class=\"bad\">" + markup(failure) + "</p>\n";
  for (const auto& controller : report.controllers) {
    if (report.passed()) continue;
    text += "<p>Controller " + markup(controller.name) + " " + markup(controller.end) +
            (controller.last_lines.empty() ? "." : "; the last that it said:") + "</p>\n";
    std::string lines;
    for (const auto& line : controller.last_lines) lines += markup(cli::printable(line)) + "\n";
    if (!lines.empty()) text += "<pre>" + lines + "</pre>\n";
  }
  return text;
}

std::string again(const Report& report) {
  std::string text = "visum run " + shell_word(report.file);
  if (report.run != 0) text += " --only " + number(report);
  for (const auto& word : report.words) text += " " + shell_word(word);
  if (!report.recording.empty()) text += "\nvisum replay " + shell_word(report.recording);
  if (!report.recording_trouble.empty()) text += "\n# the recording " + report.recording_trouble;
  return "<pre>" + markup(text) + "</pre>\n";
}

std::string body_of(const Report& report) {
  return "<p>" + std::to_string(report.ticks) + " ticks, " + cli::fixed(report.sim_seconds, 3) +
         " s simulated in " + cli::fixed(report.wall_seconds, 3) + " s, state hash <code>" +
         cli::hex(report.state_hash) + "</code></p>\n" + troubles_of(report) + checks_of(report) +
         again(report);
}

std::string section_of(const Report& report) {
  const std::string id = " id=\"run" + number(report) + "\"";
  if (!report.passed())
    return "<h2" + id + "><span class=\"bad\">FAILED</span> " + markup(heading(report)) + "</h2>\n" +
           body_of(report);
  return "<details" + id + "><summary><span class=\"good\">passed</span> " + markup(heading(report)) +
         "</summary>\n" + body_of(report) + "</details>\n";
}

std::string figures_of(std::span<const Report> reports) {
  std::vector<SweptRun> runs;
  std::vector<FigureCheck> checks;
  for (const Report& report : reports) {
    const auto outcome = report.passed()               ? SweptRun::Outcome::kPassed
                         : report.code == cli::kFailed ? SweptRun::Outcome::kFailed
                                                       : SweptRun::Outcome::kInvalid;
    runs.push_back({report.run, outcome, report.swept, "#run" + number(report)});
    for (const auto& check : report.checks) {
      if (check.value) runs.back().checks[check.name] = *check.value;
      if (std::ranges::find(checks, check.name, &FigureCheck::name) == checks.end())
        checks.push_back({check.name, check.unit, check.bound});
    }
  }
  return sweep_figures(runs, checks);
}

std::string summary_of(std::span<const Report> reports) {
  const auto failed = std::ranges::count_if(reports, [](const Report& one) { return !one.passed(); });
  std::set<std::uint64_t> hashes;
  for (const Report& report : reports) hashes.insert(report.state_hash);
  const std::string of = std::to_string(reports.size()) + (reports.size() == 1 ? " run" : " runs");
  const std::string verdict =
      failed == 0 ? "<b class=\"good\">PASSED</b>: " + of
                  : "<b class=\"bad\">FAILED</b>: " + std::to_string(failed) + " of " + of + " failed";
  return "<p>" + verdict + "; " + std::to_string(hashes.size()) + " different final states</p>\n";
}

}  // namespace

std::string report_html(std::span<const Report> reports) {
  std::vector<const Report*> order;
  for (const Report& report : reports) order.push_back(&report);
  std::stable_partition(order.begin(), order.end(), [](const Report* report) { return !report->passed(); });
  const Report& any = reports.front();
  std::string page = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" +
                     markup(any.name) + "</title><style>" + kStyle + kFigureStyle +
                     "</style></head><body>\n<h1>" + markup(any.name) + "</h1>\n" + summary_of(reports) +
                     "<p><code>" + markup(any.file) + "</code>, scene <code>" + markup(any.scene) +
                     "</code>, clock " + markup(any.clock) +
                     (any.engine.empty() ? "" : ", engine " + markup(any.engine)) + "</p>\n" +
                     figures_of(reports) + table_of(order);
  for (const Report* report : order) page += section_of(*report);
  return page + "</body></html>\n";
}

}  // namespace visum::run

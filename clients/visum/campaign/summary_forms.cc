// The forms of a summary: JSON, text, an HTML page, and CSV.
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "clients/visum/campaign/summary.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/markup.h"
#include "clients/visum/common/terminal.h"
#include "clients/visum/common/whole_file.h"
#include "clients/visum/run/sweep_figures.h"
#include "protocol/config/config.h"
#include "protocol/config/new_file.h"

namespace visum::campaign {
namespace {

using cli::markup;

constexpr std::size_t kMostDrawn = 10'000;  // runs

std::string percent(double share) {
  return cli::rounded(100.0 * share, 5) + " %";
}

std::string number(const std::optional<double>& value) {
  return value ? cli::rounded(*value, 5) : "-";
}

std::string of_runs(std::size_t count, const char* word) {
  return std::to_string(count) + " " + word;
}

std::string claim(const run::Decide& decide) {
  return "at least " + percent(decide.at_least) + " pass (rejected below " + percent(decide.reject_below) +
         "; risk of a wrong rejection " + percent(decide.false_reject) + ", of a wrong acceptance " +
         percent(decide.false_accept) + ")";
}

std::string verdict(const Summary& summary) {
  if (!summary.decide) return {};
  std::string text = std::string(to_text(summary.decision)) + ": " + claim(*summary.decide);
  if (summary.decided_at != 0) text += ", decided by run " + std::to_string(summary.decided_at);
  return text;
}

std::string numbers(const std::vector<std::size_t>& runs) {
  std::string text;
  for (std::size_t i = 0; i < runs.size() && i < 10; ++i) text += (i ? ", " : "") + std::to_string(runs[i]);
  return text + (runs.size() > 10 ? ", ..." : "");
}

std::vector<std::string> troubles(const Summary& summary) {
  std::vector<std::string> texts;
  if (!summary.missing.empty()) texts.push_back("missing: runs " + numbers(summary.missing));
  if (!summary.nondeterministic.empty())
    texts.push_back("equal runs ended in different states, so they are invalid: runs " +
                    numbers(summary.nondeterministic));
  for (const auto& file : summary.changed) texts.push_back("not the same for all runs: " + file);
  return texts;
}

void write_runs(cli::JsonWriter& json, const char* name, const std::vector<std::size_t>& runs) {
  json.key(name).begin_array();
  for (const std::size_t run : runs) json.value(run);
  json.end_array();
}

void write_number(cli::JsonWriter& json, const char* name, const std::optional<double>& value) {
  json.key(name);
  value ? json.value(*value) : json.null();
}

std::string csv_cell(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

constexpr const char* kStyle = R"(
:root{color-scheme:light dark;--line:#8886;--good:#1a7f37;--bad:#cf222e}
@media(prefers-color-scheme:dark){:root{--good:#3fb950;--bad:#f85149}}
body{font:15px/1.45 system-ui,sans-serif;max-width:1100px;margin:2em auto;padding:0 1em}
table{border-collapse:collapse;margin:1em 0;display:block;overflow-x:auto}
th,td{text-align:left;padding:.25em .7em;border-bottom:1px solid var(--line)}
td.n{text-align:right;font-variant-numeric:tabular-nums}code,td.h{font-family:ui-monospace,monospace;font-size:13px}
.good{color:var(--good)}.bad{color:var(--bad)}
)";

std::string cell(const std::string& text, const char* kind = "") {
  return std::string("<td") + (*kind ? std::string(" class=\"") + kind + "\"" : "") + ">" + markup(text) +
         "</td>";
}

std::string checks_table(const Summary& summary) {
  if (summary.checks.empty()) return {};
  std::string table =
      "<h2>Checks</h2><table><thead><tr><th>check</th><th>must be</th><th>passed</th><th>least</th><th>5 "
      "%</th>"
      "<th>median</th><th>95 %</th><th>most</th><th>least margin</th><th>in run</th></tr></thead><tbody>\n";
  for (const auto& check : summary.checks) {
    table += "<tr>" + cell(check.name) + cell(check.bound) +
             cell(std::to_string(check.passed) + " of " + std::to_string(check.runs), "n");
    for (const auto& value : {check.least, check.low, check.median, check.high, check.most, check.margin})
      table += cell(number(value), "n");
    table += cell(check.worst_run == 0 ? "-" : std::to_string(check.worst_run), "n") + "</tr>\n";
  }
  return table + "</tbody></table>\n";
}

// "speed 81 %, friction 15 %"
std::string influences_text(const CheckFigures& check) {
  std::string text;
  for (const auto& one : check.influences)
    text += (text.empty() ? "" : ", ") + one.parameter + " " + cli::rounded(100.0 * one.share, 2) + " %";
  return text;
}

std::string influences_table(const Summary& summary) {
  std::string rows;
  for (const auto& check : summary.checks)
    if (!check.influences.empty())
      rows += "<tr>" + cell(check.name) + cell(influences_text(check)) + "</tr>\n";
  if (rows.empty()) return {};
  return "<h2>Which parameters matter</h2>\n<p>The share of the variance of a check's margin that goes with "
         "one "
         "parameter alone.</p>\n<table><thead><tr><th>check</th><th>parameters</th></tr></thead><tbody>\n" +
         rows + "</tbody></table>\n";
}

std::string recording_cell(const Row& row) {
  if (row.recording.empty()) return "<td></td>";
  return "<td><a href=\"" + markup(row.recording) + "\">" + markup(row.recording) + "</a></td>";
}

std::string failures_table(const Summary& summary, const std::string& file) {
  const std::size_t bad = summary.failed + summary.invalid;
  if (bad == 0) return {};
  std::string table = "<h2>Runs that did not pass</h2>\n";
  if (bad > summary.failures.size())
    table += "<p>The first " + std::to_string(summary.failures.size()) + " of " + std::to_string(bad) +
             "; results.csv has all.</p>\n";
  table +=
      "<table><thead><tr><th>run</th><th>values</th><th>result</th><th>why</th><th>recording</th><th>state "
      "hash</th></tr></thead><tbody>\n";
  for (const Row& row : summary.failures)
    table += "<tr>" + cell(std::to_string(row.run), "n") + cell(values_text(row)) +
             cell(word_of(row.outcome()), "bad") + cell(row.error) + recording_cell(row) +
             cell(cli::hex(row.state_hash), "h") + "</tr>\n";
  return table + "</tbody></table>\n<p>Again: <code>visum run " + markup(file) +
         " --only RUN</code>; a recording: <code>visum replay FILE</code></p>\n";
}

}  // namespace

std::string summary_json(const Summary& summary) {
  cli::JsonWriter json;
  json.begin_object().member("runs", summary.runs).member("passed", summary.passed);
  json.member("failed", summary.failed).member("invalid", summary.invalid).member("reused", summary.reused);
  json.member("pass_rate", summary.pass_rate).member("low", summary.interval.low);
  json.member("high", summary.interval.high).key("decision");
  summary.decide ? json.value(to_text(summary.decision)) : json.null();
  json.member("hash", cli::hex(summary.hash)).member("all", summary.all).key("decided_at");
  summary.decided_at != 0 ? json.value(summary.decided_at) : json.null();
  write_runs(json, "missing", summary.missing);
  write_runs(json, "nondeterministic", summary.nondeterministic);
  json.key("changed").begin_array();
  for (const auto& file : summary.changed) json.value(file);
  json.end_array().key("checks").begin_array();
  for (const auto& check : summary.checks) {
    json.begin_object().member("check", check.name).member("unit", check.unit).member("bound", check.bound);
    json.member("runs", check.runs).member("passed", check.passed);
    write_number(json, "least", check.least);
    write_number(json, "low", check.low);
    write_number(json, "median", check.median);
    write_number(json, "high", check.high);
    write_number(json, "most", check.most);
    write_number(json, "margin", check.margin);
    json.member("worst_run", check.worst_run).key("influence").begin_object();
    for (const auto& one : check.influences) json.member(one.parameter, one.share);
    json.end_object().end_object();
  }
  json.end_array();
  if (summary.search) write_search(json, *summary.search);
  return json.end_object().text();
}

std::string summary_text(const Summary& summary) {
  std::string text = of_runs(summary.runs, "runs") + ": " + of_runs(summary.passed, "passed") + ", " +
                     of_runs(summary.failed, "failed") + ", " + of_runs(summary.invalid, "invalid");
  if (summary.reused > 0) text += "; " + of_runs(summary.reused, "were there already");
  text += "\npass rate " + percent(summary.pass_rate) + ", with 95 % confidence from " +
          percent(summary.interval.low) + " to " + percent(summary.interval.high) + "\n";
  if (summary.decide) text += verdict(summary) + "\n";
  for (const auto& trouble : troubles(summary)) text += trouble + "\n";
  if (!summary.checks.empty()) {
    cli::Table table;
    table.row({"check", "passed", "5 %", "median", "95 %", "least margin", "in run"});
    for (const auto& check : summary.checks)
      table.row({check.name, std::to_string(check.passed) + "/" + std::to_string(check.runs),
                 number(check.low), number(check.median), number(check.high), number(check.margin),
                 check.worst_run == 0 ? "-" : std::to_string(check.worst_run)});
    text += table.text();
    for (const auto& check : summary.checks)
      if (!check.influences.empty())
        text += "the margin of '" + check.name + "' goes with " + influences_text(check) + "\n";
  }
  if (summary.search) text += search_text(*summary.search);
  return text + "hash " + cli::hex(summary.hash) + "\n";
}

std::string summary_html(const Summary& summary, const Identity& identity, const std::string& of,
                         const std::string& figures) {
  const auto code = summary.code();
  const char* kind = code == cli::kDone ? "good" : "bad";
  std::string page = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>" +
                     markup(identity.name) + "</title><style>" + kStyle + run::kFigureStyle +
                     "</style></head><body>\n<h1>" + markup(identity.name) + "</h1>\n<p><code>" +
                     markup(identity.file) + "</code>" + markup(of) + "</p>\n";
  if (summary.decide)
    page += "<p><b class=\"" + std::string(kind) + "\">" + markup(verdict(summary)) + "</b></p>\n";
  page += "<p><b class=\"" + std::string(kind) + "\">" + percent(summary.pass_rate) + "</b> of " +
          std::to_string(summary.passed + summary.failed) + " valid runs passed; with 95 % confidence " +
          percent(summary.interval.low) + " to " + percent(summary.interval.high) + " of all do. " +
          of_runs(summary.failed, "failed") + ", " + of_runs(summary.invalid, "are invalid") + ".</p>\n";
  for (const auto& trouble : troubles(summary)) page += "<p class=\"bad\">" + markup(trouble) + "</p>\n";
  return page + "<p>Hash <code>" + cli::hex(summary.hash) + "</code></p>\n" + figures +
         checks_table(summary) + influences_table(summary) +
         (summary.search ? search_html(*summary.search) : "") + failures_table(summary, identity.file) +
         "</body></html>\n";
}

void write_csv(Results& results, std::size_t last, const std::filesystem::path& file) {
  const config::NewFile whole(file);
  std::ofstream out(whole.path());
  Statement checks(results.database(),
                   "SELECT name, passed, value, unit, margin FROM checks WHERE run = ? ORDER BY number");
  bool begun = false;
  results.for_each(last, [&](const Row& row) {
    const auto values = values_of(row);
    if (!begun) {
      out << "run";
      for (const auto& [name, value] : values) out << ',' << csv_cell(name);
      out << ",result,code,state_hash,ticks,check,check_passed,value,unit,margin\n";
      begun = true;
    }
    std::string head = std::to_string(row.run);
    for (const auto& [name, value] : values) head += ',' + csv_cell(value);
    head += ',' + word_of(row.outcome()) + ',' + std::to_string(row.code) + ',' + cli::hex(row.state_hash) +
            ',' + std::to_string(row.ticks);
    bool any = false;
    checks.reset().bind(row.run);
    while (checks.step()) {
      const auto exact = [&](int column) {
        return checks.real(column) ? cli::exact(*checks.real(column)) : "";
      };
      out << head << ',' << csv_cell(checks.text(0)) << ',' << checks.integer(1) << ',' << exact(2) << ','
          << csv_cell(checks.text(3)) << ',' << exact(4) << '\n';
      any = true;
    }
    if (!any) out << head << ",,,,,\n";
  });
  out.close();
  if (!out)
    throw cli::ExitError(cli::kInvalid, "cannot write " + file.string() + ": " + std::strerror(errno));
  whole.keep();
}

std::string figures_html(Results& results, const Summary& summary, std::size_t last) {
  std::vector<run::SweptRun> runs;
  Statement values(results.database(), "SELECT name, value FROM checks WHERE run = ? AND value IS NOT NULL");
  results.for_each(std::min(last, kMostDrawn), [&](const Row& row) {
    const auto outcome = row.outcome() == SequentialTest::Outcome::kPassed ? run::SweptRun::Outcome::kPassed
                         : row.outcome() == SequentialTest::Outcome::kFailed
                             ? run::SweptRun::Outcome::kFailed
                             : run::SweptRun::Outcome::kInvalid;
    runs.push_back({row.run, outcome, values_of(row), row.recording});
    values.reset().bind(row.run);
    while (values.step()) runs.back().checks[values.text(0)] = values.real(1).value_or(0.0);
  });
  std::vector<run::FigureCheck> checks;
  for (const auto& check : summary.checks) checks.push_back({check.name, check.unit, check.bound});
  const std::string figures = run::sweep_figures(runs, checks);
  if (figures.empty() || last <= kMostDrawn) return figures;
  return figures + "<p>Drawn from the first " + std::to_string(kMostDrawn) + " runs.</p>\n";
}

void write_reports(Results& results, const Summary& summary, const std::filesystem::path& folder) try {
  const Shard& shard = results.shard();
  const std::string of = shard.count == 1 ? "" : ", shard " + shard.text();
  const std::size_t last = summary.decided_at != 0 ? summary.decided_at : results.identity().runs;
  write_csv(results, last, folder / "results.csv");
  cli::write_whole_file(folder / "summary.json", summary_json(summary) + "\n");
  cli::write_whole_file(folder / "report.html",
                        summary_html(summary, results.identity(), of, figures_html(results, summary, last)));
} catch (const cli::ExitError&) {
  throw;
} catch (const std::runtime_error& error) {  // of write_whole_file() and the file system
  throw cli::ExitError(cli::kInvalid, error.what());
}

}  // namespace visum::campaign

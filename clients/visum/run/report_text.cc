#include <algorithm>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/run/reports.h"
#include "protocol/command_line/help.h"

namespace visum::run {
namespace {

using command_line::kWidth;
using command_line::wrapped;

constexpr std::size_t kIndent = 10;  // where text stands below "  passed  "

std::string measured(const CheckResult& check) {
  if (!check.value) return "never looked at, must be " + check.bound;
  return check.text + " " + value_text(check, 5) + " at " + cli::fixed(check.at_s, 3) + " s, must be " +
         check.bound;
}

std::string verdict(const Report& report, const CheckResult& check, const cli::Style& style) {
  if (check.passed) return style.green("passed");
  return check.value || report.error.empty() ? style.red("FAILED") : style.dim("  -   ");
}

// `text` in lines of at most 80 columns that begin with kIndent blanks, the first line without them.
std::string indented(const std::string& text) {
  std::string result;
  for (const char c : wrapped(text, 0, kWidth - kIndent)) {
    result += c;
    if (c == '\n') result.append(kIndent, ' ');
  }
  return result;
}

// Name and measured value stand on one line if all checks of the run fit so, else on two.
std::string check_lines(const Report& report, const cli::Style& style) {
  std::size_t widest_name = 0, widest_value = 0;
  for (const auto& check : report.checks) {
    widest_name = std::max(widest_name, check.name.size());
    widest_value = std::max(widest_value, measured(check).size());
  }
  const bool fits = kIndent + widest_name + 2 + widest_value <= kWidth;
  std::string text;
  for (const auto& check : report.checks) {
    text += "  " + verdict(report, check, style) + "  ";
    if (fits)
      text += check.name + std::string(widest_name - check.name.size() + 2, ' ') + measured(check) + "\n";
    else
      text += indented(check.name) + "\n" + std::string(kIndent, ' ') + indented(measured(check)) + "\n";
  }
  return text;
}

// For a run that failed, and whose recording in case is missing or cut short. A recording that was asked for
// is among the failures.
std::string recording_note(const Report& report, const std::string& before) {
  const auto is_said = [&](const auto& failure) { return failure.ends_with(report.recording_trouble); };
  if (report.passed() || report.recording_trouble.empty() || std::ranges::any_of(report.failures, is_said))
    return {};
  return before + (report.recording.empty() ? "there is no recording: it " : "the recording ") +
         report.recording_trouble + "\n";
}

// Messages stay on one line, however long: people search logs for them.
std::string trouble(const Report& report, const cli::Style& style) {
  std::string text;
  for (const auto& failure : report.failures) text += "  " + style.red("FAILED") + "  " + failure + "\n";
  if (!report.error.empty()) text += "  " + style.red("ERROR") + "   " + report.error + "\n";
  text += recording_note(report, "  note    ");
  for (const auto& controller : report.controllers) {
    if (controller.failure.empty()) continue;
    text += "  last lines of " + controller.name + ":\n";
    for (const auto& line : controller.last_lines) text += "    | " + cli::printable(line) + "\n";
  }
  return text;
}

std::string figures(const Report& report) {
  const double factor = report.wall_seconds > 0.0 ? report.sim_seconds / report.wall_seconds : 0.0;
  return "  " + cli::fixed(report.sim_seconds, 3) + " s simulated in " + cli::fixed(report.wall_seconds, 3) +
         " s (" + cli::rounded(factor, 3) + " x real time), " + std::to_string(report.ticks) +
         " ticks,\n  state hash " + cli::hex(report.state_hash) + "\n";
}

// "12.0": with a point, so that a reader takes it for a number with a fraction.
std::string with_point(double number) {
  const std::string text = cli::exact(number);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

std::size_t failed(std::span<const Report> reports) {
  return static_cast<std::size_t>(
      std::ranges::count_if(reports, [](const Report& one) { return !one.passed(); }));
}

// Why a run of a sweep failed, a line for each reason.
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
  text += recording_note(report, "    note    ");
  return text;
}

// A run with limited ticks counts, but its physics was rougher there.
std::string limits(const Report& report) {
  if (report.limited_ticks == 0) return "";
  std::string bodies;
  for (const auto& body : report.limited_bodies)
    bodies += (bodies.empty() ? ": " : ", ") + cli::printable(body);
  return "  " +
         wrapped("note: " + std::to_string(report.limited_ticks) +
                     " ticks met the limit of their work (work_limit); fell short in the last of them" +
                     (bodies.empty() ? ": none" : bodies),
                 2) +
         "\n";
}

std::string trips(const Report& report) {
  std::string text;
  for (const auto& one : report.tripped) text += "  " + wrapped("tripped: " + cli::printable(one), 2) + "\n";
  return text;
}

}  // namespace

std::string swept_text(const Report& report) {
  std::string text;
  for (const auto& [name, value] : report.swept) text += (text.empty() ? "" : ", ") + name + "=" + value;
  return text;
}

std::string title(const Report& report) {
  if (report.run == 0) return report.name + (report.swept.empty() ? "" : " [" + swept_text(report) + "]");
  return report.name + " [run " + std::to_string(report.run) + ": " + swept_text(report) + "]";
}

std::string report_text(const Report& report, const cli::Style& style) {
  const auto passed =
      std::count_if(report.checks.begin(), report.checks.end(), [](const auto& c) { return c.passed; });
  std::string origin = report.scene + ", " + report.clock;
  if (!report.engine.empty()) origin += ", engine " + report.engine;
  if (report.seed >= 0) origin += ", seed " + std::to_string(report.seed);
  const bool fits = report.name.size() + origin.size() + 3 <= kWidth;
  std::string text =
      style.bold(report.name) + (fits ? " (" + origin + ")\n" : "\n  " + wrapped(origin, 2) + "\n");
  text +=
      check_lines(report, style) + trouble(report, style) + figures(report) + limits(report) + trips(report);
  const bool invalid = report.code == cli::kInvalid;
  text += (report.passed() ? style.green("PASSED") : style.red(invalid ? "INVALID" : "FAILED")) + ": " +
          std::to_string(passed) + " of " + std::to_string(report.checks.size()) + " checks\n";
  return text;
}

std::string report_json(const Report& report) {
  const bool valid = report.code != cli::kInvalid;
  cli::JsonWriter json;
  json.begin_object().member("passed", report.passed()).member("valid", valid);
  if (!valid)
    json.member("invalid_reason", report.error).member("invalid", true);  // `invalid`: for one release
  json.member("ticks", report.ticks);
  json.key("sim_seconds").number(with_point(report.sim_seconds));
  json.key("wall_seconds").number(with_point(report.wall_seconds));
  if (report.limited_ticks > 0) json.member("limited_ticks", report.limited_ticks);
  if (!report.tripped.empty()) {
    json.key("tripped").begin_array();
    for (const auto& one : report.tripped) json.value(one);
    json.end_array();
  }
  return json.member("state_hash", cli::hex(report.state_hash)).end_object().text();
}

std::string checks_json(const Report& report) {
  std::string lines;
  for (const auto& check : report.checks) {
    cli::JsonWriter json;
    json.begin_object().member("check", check.name).member("passed", check.passed).key("value");
    check.value ? json.value(*check.value) : json.null();
    json.member("unit", check.unit).member("bound", check.bound).member("at_s", check.at_s);
    if (!check.words.empty()) json.member("words", check.words);
    lines += json.end_object().text() + "\n";
  }
  return lines;
}

std::string run_line(const Report& report, const cli::Style& style) {
  const auto good = std::ranges::count_if(report.checks, &CheckResult::passed);
  std::string line = "run " + std::to_string(std::max<std::size_t>(report.run, 1));
  if (!report.swept.empty()) line += ": " + swept_text(report);
  const std::string outcome = std::to_string(good) + " of " + std::to_string(report.checks.size()) +
                              " checks, " + cli::hex(report.state_hash);
  const bool fits = kIndent + line.size() + 2 + outcome.size() <= kWidth;
  line = fits ? line + "  " + outcome : indented(line) + "\n" + std::string(kIndent, ' ') + outcome;
  return (report.passed() ? style.green("passed") : style.red("FAILED")) + "  " + line + "\n" +
         reasons(report, style);
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

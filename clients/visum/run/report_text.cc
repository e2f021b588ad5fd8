#include "clients/visum/run/report_text.h"

#include <algorithm>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"

namespace visum::run {
namespace {

std::string measured(const CheckResult& check) {
  if (!check.value) return "never looked at, must be " + check.bound;
  return check.text + " " + cli::rounded(*check.value, 5) + (check.unit.empty() ? "" : " " + check.unit) +
         " at " + cli::fixed(check.at_s, 3) + " s, must be " + check.bound;
}

std::string verdict(const Report& report, const CheckResult& check, const cli::Style& style) {
  if (check.passed) return style.green("passed");
  return check.value || report.error.empty() ? style.red("FAILED") : style.dim("  -   ");
}

std::string check_lines(const Report& report, const cli::Style& style) {
  std::size_t widest = 0;
  for (const auto& check : report.checks) widest = std::max(widest, check.name.size());
  std::string text;
  for (const auto& check : report.checks) {
    text += "  " + verdict(report, check, style) + "  " + check.name +
            std::string(widest - check.name.size() + 2, ' ') + measured(check) + "\n";
  }
  return text;
}

std::string trouble(const Report& report, const cli::Style& style) {
  std::string text;
  for (const auto& failure : report.failures) text += "  " + style.red("FAILED") + "  " + failure + "\n";
  if (!report.error.empty()) text += "  " + style.red("ERROR") + "   " + report.error + "\n";
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
         " ticks, state hash " + cli::hex(report.state_hash) + "\n";
}

// "12.0", as a number with a point, so that a reader takes it for what it is.
std::string with_point(double number) {
  const std::string text = cli::exact(number);
  return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

}  // namespace

std::string report_text(const Report& report, const cli::Style& style) {
  const auto passed =
      std::count_if(report.checks.begin(), report.checks.end(), [](const auto& c) { return c.passed; });
  std::string text = style.bold(report.name) + " (" + report.scene + ", " + report.clock;
  if (!report.engine.empty()) text += ", engine " + report.engine;
  if (report.seed >= 0) text += ", seed " + std::to_string(report.seed);
  text += ")\n" + check_lines(report, style) + trouble(report, style) + figures(report);
  const bool invalid = report.code == cli::kInvalid;
  text += (report.passed() ? style.green("PASSED") : style.red(invalid ? "INVALID" : "FAILED")) + ": " +
          std::to_string(passed) + " of " + std::to_string(report.checks.size()) + " checks\n";
  return text;
}

std::string report_json(const Report& report) {
  cli::JsonWriter json;
  json.begin_object().member("passed", report.passed()).member("ticks", report.ticks);
  json.key("sim_seconds").number(with_point(report.sim_seconds));
  json.key("wall_seconds").number(with_point(report.wall_seconds));
  if (report.code == cli::kInvalid) json.member("invalid", true);
  return json.member("state_hash", cli::hex(report.state_hash)).end_object().text();
}

std::string checks_json(const Report& report) {
  std::string lines;
  for (const auto& check : report.checks) {
    cli::JsonWriter json;
    json.begin_object().member("check", check.name).member("passed", check.passed).key("value");
    check.value ? json.value(*check.value) : json.null();
    json.member("unit", check.unit).member("bound", check.bound).member("at_s", check.at_s);
    lines += json.end_object().text() + "\n";
  }
  return lines;
}

}  // namespace visum::run

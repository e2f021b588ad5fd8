#include "clients/visum/run/event_lines.h"

#include <algorithm>
#include <cstdio>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "protocol/config/printable.h"

namespace visum::run {
namespace {

// All texts of a line, escaped for JSON, stay below 4096 bytes.
std::string clean(const std::string& text, std::size_t most = 1000) {
  return config::shortened(config::printable(text), most);
}

void print(cli::JsonWriter& json) {
  std::puts(json.end_object().text().c_str());
  std::fflush(stdout);
}

cli::JsonWriter begun(const char* event) {
  cli::JsonWriter json;
  json.begin_object().member("event", event);
  return json;
}

std::string text_of(const CheckResult& check) {
  if (!check.failure.empty()) return check.failure;
  return check.text + " is " + value_text(check, 6) + " at " + cli::fixed(check.at_s, 3) + " s, must be " +
         check.bound;
}

// Why the run failed, or how many checks it passed.
std::string text_of(const Report& report) {
  std::string text;
  const auto add = [&](const std::string& why) { text += (text.empty() ? "" : "; ") + why; };
  if (!report.error.empty()) add(report.error);
  for (const auto& failure : report.failures) add(failure);
  const auto good = std::ranges::count_if(report.checks, &CheckResult::passed);
  add(std::to_string(good) + " of " + std::to_string(report.checks.size()) + " checks");
  return text;
}

void end_with(bool passed, bool valid, int code, const std::string& text, const Report* report) {
  auto json = begun("end");
  json.member("passed", passed).member("valid", valid).member("code", code).member("text", clean(text));
  if (report && report->ticks > 0) {
    json.member("ticks", report->ticks).member("sim_seconds", report->sim_seconds);
    json.member("wall_seconds", report->wall_seconds).member("state_hash", cli::hex(report->state_hash));
  }
  print(json);
}

}  // namespace

void EventLines::begin(const std::string& name, std::size_t runs, std::size_t checks) {
  auto json = begun("begin");
  json.member("name", clean(name)).member("runs", runs).member("checks", checks);
  print(json);
}

void EventLines::line(const std::string& who, const std::string& text) {
  auto json = begun("line");
  json.member("source", clean(who, 200)).member("text", clean(text));
  print(json);
}

void EventLines::check(const CheckResult& check) {
  auto json = begun("check");
  json.member("check", clean(check.name, 500)).member("passed", check.passed);
  json.member("text", clean(text_of(check)));
  print(json);
}

void EventLines::end(const Report& report) {
  end_with(report.passed(), report.code != cli::kInvalid, report.code, text_of(report), &report);
}

void EventLines::run(const Report& report) {
  auto json = begun("run");
  json.member("run", std::max<std::size_t>(report.run, 1)).member("values", clean(swept_text(report), 500));
  json.member("passed", report.passed()).member("code", static_cast<int>(report.code));
  json.member("text", clean(text_of(report))).member("state_hash", cli::hex(report.state_hash));
  print(json);
}

void EventLines::end(std::span<const Report> reports, int code) {
  const auto good = std::ranges::count_if(reports, &Report::passed);
  const bool invalid = code == cli::kInvalid;
  end_with(code == cli::kDone, !invalid, code,
           std::to_string(good) + " of " + std::to_string(reports.size()) + " runs", nullptr);
}

}  // namespace visum::run

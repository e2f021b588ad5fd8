#include "clients/visum/run/reports.h"

#include <charconv>
#include <limits>

#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "protocol/config/config.h"

namespace visum::run {
namespace {

using cli::JsonWriter;
using config::Node;

constexpr int kVersion = 1;

void write_texts(JsonWriter& json, const char* name, const std::vector<std::string>& texts) {
  json.key(name).begin_array();
  for (const auto& text : texts) json.new_line().value(text);
  json.end_array();
}

void write_check(JsonWriter& json, const CheckResult& check) {
  json.new_line().begin_object().member("check", check.name).member("text", check.text);
  json.member("bound", check.bound).member("unit", check.unit).member("passed", check.passed).key("value");
  check.value ? json.value(*check.value) : json.null();
  json.key("margin");
  check.margin ? json.value(*check.margin) : json.null();
  json.member("measured", check.value.has_value()).member("at_s", check.at_s);
  if (!check.words.empty()) json.member("words", check.words);
  json.member("failure", check.failure).key("limits").begin_array();
  for (const double limit : check.limits) json.value(limit);
  json.end_array().new_line().key("course").begin_array();
  for (const auto& point : check.course)
    json.begin_array().value(point.at_s).value(point.lowest).value(point.highest).end_array();
  json.end_array().end_object();
}

void write_controller(JsonWriter& json, const ControllerResult& controller) {
  json.new_line().begin_object().member("name", controller.name).member("end", controller.end);
  json.member("failure", controller.failure);
  write_texts(json, "last_lines", controller.last_lines);
  json.end_object();
}

void write_swept(JsonWriter& json, const Report& report) {
  json.member("run", report.run).key("sweep").begin_object();
  for (const auto& [name, value] : report.swept) json.member(name, value);
  json.end_object().new_line();
}

double read_number(const Node& node) {
  return node.kind() == Node::Kind::kNull ? std::numeric_limits<double>::quiet_NaN() : node.number();
}

std::vector<std::string> read_texts(const Node& list) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < list.size(); ++i) texts.push_back(list.at(i).text());
  return texts;
}

std::uint64_t read_hash(const Node& node) {
  const std::string text = node.text();
  std::uint64_t hash = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), hash, 16);
  if (error != std::errc() || end != text.data() + text.size()) node.fail("is no hash");
  return hash;
}

CheckResult read_check(const Node& node) {
  CheckResult check;
  check.name = node.get("check").text();
  check.text = node.get("text").text();
  check.bound = node.get("bound").text();
  check.unit = node.get("unit").text();
  check.passed = node.get("passed").boolean();
  if (node.get("measured").boolean()) check.value = read_number(node.get("value"));
  check.at_s = node.get("at_s").number();
  if (check.value && node.get("margin").kind() == Node::Kind::kScalar)
    check.margin = node.get("margin").number();
  if (const auto words = node.find("words")) check.words = words->text();
  check.failure = node.get("failure").text();
  const Node limits = node.get("limits"), course = node.get("course");
  for (std::size_t i = 0; i < limits.size(); ++i) check.limits.push_back(read_number(limits.at(i)));
  for (std::size_t i = 0; i < course.size(); ++i) {
    const auto point = course.at(i).numbers(3);
    check.course.push_back({point[0], point[1], point[2]});
  }
  return check;
}

}  // namespace

std::string report_as_json(const Report& report) {
  JsonWriter json;
  json.begin_object()
      .member("visum_result", kVersion)
      .member("name", report.name)
      .member("file", report.file);
  json.member("scene", report.scene).member("clock", report.clock).member("engine", report.engine);
  json.member("seed", report.seed).member("recording", report.recording);
  json.member("recording_trouble", report.recording_trouble);
  write_swept(json, report);
  json.member("code", static_cast<int>(report.code)).member("error", report.error);
  write_texts(json, "failures", report.failures);
  json.key("checks").begin_array();
  for (const auto& check : report.checks) write_check(json, check);
  json.end_array().key("controllers").begin_array();
  for (const auto& controller : report.controllers) write_controller(json, controller);
  json.end_array().new_line().member("ticks", report.ticks).member("sim_seconds", report.sim_seconds);
  json.member("wall_seconds", report.wall_seconds).member("state_hash", cli::hex(report.state_hash));
  json.key("files").begin_array();
  for (const auto& [file, hash] : report.files)
    json.new_line().begin_array().value(file).value(hash).end_array();
  return json.end_array().end_object().text() + "\n";
}

Report read_report(const std::filesystem::path& file) {
  const Node root = config::load_file(file);
  if (root.get("visum_result").integer() != kVersion) root.fail("this program reads version 1");
  Report report;
  report.name = root.get("name").text();
  report.file = root.get("file").text();
  report.scene = root.get("scene").text();
  report.clock = root.get("clock").text();
  report.engine = root.get("engine").text();
  report.seed = root.get("seed").integer();
  report.recording = root.get("recording").text();
  report.recording_trouble = root.get("recording_trouble").text();
  report.run = static_cast<std::size_t>(root.get("run").integer(0));
  const Node swept = root.get("sweep"), checks = root.get("checks"), controllers = root.get("controllers");
  for (const auto& name : swept.keys()) report.swept.emplace_back(name, swept.get(name).text());
  report.code = static_cast<cli::ExitCode>(root.get("code").integer(0, 255));
  report.error = root.get("error").text();
  report.failures = read_texts(root.get("failures"));
  for (std::size_t i = 0; i < checks.size(); ++i) report.checks.push_back(read_check(checks.at(i)));
  for (std::size_t i = 0; i < controllers.size(); ++i) {
    const Node one = controllers.at(i);
    report.controllers.push_back({one.get("name").text(), one.get("end").text(), one.get("failure").text(),
                                  read_texts(one.get("last_lines"))});
  }
  report.ticks = root.get("ticks").integer();
  report.sim_seconds = root.get("sim_seconds").number();
  report.wall_seconds = root.get("wall_seconds").number();
  report.state_hash = read_hash(root.get("state_hash"));
  const Node files = root.get("files");
  for (std::size_t i = 0; i < files.size(); ++i)
    report.files.emplace_back(files.at(i).at(0).text(), files.at(i).at(1).text());
  return report;
}

}  // namespace visum::run

#include <algorithm>
#include <csignal>

#include "clients/visum/run/lookup.h"
#include "clients/visum/run/scenario_parts.h"

namespace visum::run {
namespace {

using config::Node;

SetPort read_set(const Node& node) {
  node.allow_only({"part", "port", "value", "take"});
  return {node.get("part").text(), node.get("port").text(), node.get("value").number(),
          node.boolean_or("take", false)};
}

Push read_push(const Node& node) {
  node.allow_only({"body", "force_n", "torque_nm", "point_m", "duration_s"});
  Push push;
  push.body = node.get("body").text();
  push.force_n = node.get("force_n").numbers(3);
  if (const auto torque = node.find("torque_nm")) push.torque_nm = torque->numbers(3);
  if (const auto point = node.find("point_m")) push.point_m = point->numbers(3);
  push.duration_s = node.number_or("duration_s", push.duration_s, config::kPositive);
  return push;
}

SetParameter read_parameter(const Node& node) {
  node.allow_only({"part", "name", "value"});
  return {node.get("part").text(), node.get("name").text(), node.get("value").text()};
}

InjectFault read_fault(const Node& node) {
  node.allow_only({"part", "kind", "numbers", "for_s"});
  InjectFault fault{node.get("part").text(), node.get("kind").text(), {}, 0.0};
  if (const auto numbers = node.find("numbers"))
    for (const auto& name : numbers->keys()) fault.numbers.emplace_back(name, numbers->get(name).number());
  fault.duration_s = node.number_or("for_s", 0.0, config::kPositive);
  return fault;
}

ClearFault read_clear(const Node& node) {
  node.allow_only({"part", "kind", "joint"});
  const auto joint = node.find("joint");
  return {node.get("part").text(), node.text_or("kind", ""),
          joint ? static_cast<int>(joint->integer(1, 1000)) : 0};
}

const std::string& check_controller(const Node& node, const std::string& name,
                                    const std::vector<ControllerSpec>& controllers) {
  std::vector<std::string> known;
  for (const ControllerSpec& controller : controllers) known.push_back(controller.name);
  if (std::find(known.begin(), known.end(), name) == known.end()) {
    fail_unknown(node.place(), "controller", name, known);
  }
  return name;
}

Signal read_signal(const Node& node, const std::vector<ControllerSpec>& controllers) {
  node.allow_only({"controller", "signal"});
  const std::string name = node.get("signal").one_of({"INT", "TERM", "KILL"});
  const int number = name == "INT" ? SIGINT : name == "TERM" ? SIGTERM : SIGKILL;
  const Node controller = node.get("controller");
  return {check_controller(controller, controller.text(), controllers), number};
}

Action read_action(const Node& entry, const std::string& key,
                   const std::vector<ControllerSpec>& controllers) {
  const Node node = entry.get(key);
  if (key == "set") return read_set(node);
  if (key == "push") return read_push(node);
  if (key == "parameter") return read_parameter(node);
  if (key == "fault") return read_fault(node);
  if (key == "clear_fault") return read_clear(node);
  if (key == "kill") return Signal{check_controller(node, node.text(), controllers), SIGKILL};
  if (key == "signal") return read_signal(node, controllers);
  if (key == "remove_body") return RemoveBody{node.text()};
  return Say{node.text()};
}

}  // namespace

TimelineEntry read_timeline_entry(const Node& node, const std::vector<ControllerSpec>& controllers) {
  static const std::vector<std::string> kActions{"set",  "push",   "parameter",   "fault", "clear_fault",
                                                 "kill", "signal", "remove_body", "say"};
  node.allow_only({"at_s", "when", "set", "push", "parameter", "fault", "clear_fault", "kill", "signal",
                   "remove_body", "say"});
  TimelineEntry entry;
  entry.place = node.place();
  const auto at = node.find("at_s"), when = node.find("when");
  if (at.has_value() == when.has_value()) node.fail("needs either 'at_s' or 'when'");
  if (at) entry.at_s = at->number(config::kNonNegative);
  if (when) entry.when = read_condition(*when);
  int actions = 0;
  for (const std::string& key : kActions) {
    if (!node.find(key)) continue;
    ++actions;
    entry.action = read_action(node, key, controllers);
  }
  if (actions != 1)
    node.fail(
        "needs exactly one of set, push, parameter, fault, clear_fault, kill, signal, remove_body, say");
  return entry;
}

}  // namespace visum::run

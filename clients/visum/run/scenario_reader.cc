#include "clients/visum/run/scenario_reader.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "clients/visum/run/decide.h"
#include "clients/visum/run/placeholders.h"
#include "clients/visum/run/scenario_parts.h"
#include "clients/visum/run/search_spec.h"
#include "clients/visum/run/session.h"
#include "clients/visum/run/sweep.h"
#include "protocol/config/flow.h"
#include "protocol/config/unknown_name.h"

namespace visum::run {
namespace {

using config::Node;

// Wall and simulated times end somewhere, so that nothing can overflow: 10^7 s are 115 days.
constexpr config::Range kSeconds{0.0, 1e7, false};
constexpr config::Range kSomeSeconds{0.0, 1e7, true};

std::vector<Node> items(const Node& root, const char* key) {
  std::vector<Node> nodes;
  const auto list = root.find(key);
  if (!list) return nodes;
  if (list->kind() != Node::Kind::kList) list->fail("must be a list");
  for (std::size_t i = 0; i < list->size(); ++i) {
    nodes.push_back(list->at(i));
    if (nodes.back().kind() != Node::Kind::kMap) nodes.back().fail("must be a map");
  }
  return nodes;
}

// A bridge is another controller that exchanges something itself. So no chain of bridges can be a circle.
void check_bridge(const Node& node, const std::vector<ControllerSpec>& controllers) {
  const auto through = node.find("through");
  if (!through) return;
  std::vector<std::string> others;
  for (const ControllerSpec& other : controllers) {
    if (other.name == node.get("name").text()) continue;
    others.push_back(other.name);
    if (other.name != through->text()) continue;
    if (!other.exchanges || !other.through.empty())
      through->fail("'" + other.name + "' must exchange something itself");
    return;
  }
  through->fail(config::unknown_name("other controller", through->text(), others));
}

void read_controllers(const Node& root, Scenario& scenario) {
  for (const Node& node : items(root, "controllers")) {
    ControllerSpec controller = read_controller(node);
    for (const ControllerSpec& other : scenario.controllers) {
      if (other.name == controller.name) node.fail("a second controller '" + controller.name + "'");
      if (other.client == controller.client)
        node.fail("a second controller with client '" + controller.client + "'");
    }
    scenario.controllers.push_back(std::move(controller));
  }
  for (const Node& node : items(root, "controllers")) check_bridge(node, scenario.controllers);
}

void read_buses(const Node& root, Scenario& scenario) {
  const auto buses = root.find("buses");
  if (!buses) return;
  if (buses->kind() != Node::Kind::kMap) buses->fail("must be a map: {arm: pty}");
  for (const std::string& part : buses->keys())
    scenario.buses[part] = buses->get(part).one_of({"pty", "tcp", "slcan"});
}

void check_buses(const Scenario& scenario) {
  for (const ControllerSpec& controller : scenario.controllers) {
    for (const std::string& word : controller.command) {
      for (const std::string& part : parts_with_bus(word)) {
        if (scenario.buses.contains(part)) continue;
        throw config::ConfigError(controller.place,
                                  "{bus." + part + "}: 'buses' gives no bus to '" + part + "'");
      }
    }
  }
}

// Reads how a program that knows nothing of a clock keeps in step.
void read_step(const Node& node, ControllerSpec& controller) {
  if (const auto shim = node.find("shim")) controller.shim = shim->boolean();
  controller.gate = node.text_or("gate", "");
  if (controller.shim && !controller.gate.empty()) node.fail("shim and gate exclude each other");
  controller.period_ms = node.number_or("period_ms", 0.0, {0.0, 1e6, true});
  controller.wait_s = node.number_or("wait_s", 0.0, kSomeSeconds);
  if (const auto way = node.find("on_timeout"))
    controller.on_timeout = way->one_of({"end", "hold", "stop", "free"});
  for (const char* key : {"period_ms", "wait_s", "on_timeout"}) {
    if (!controller.shim && controller.gate.empty() && node.find(key))
      node.get(key).fail("only with shim or gate");
  }
}

Until read_until(const Node& root, const Scenario& scenario) {
  const auto node = root.find("until");
  Until until;
  if (node && node->kind() == Node::Kind::kMap && node->find("at_s")) {
    node->allow_only({"at_s"});
    until.kind = Until::Kind::kTime;
    until.at_s = node->get("at_s").number(kSeconds);
  } else if (node && node->kind() == Node::Kind::kMap) {
    until.kind = Until::Kind::kCondition;
    until.condition = read_condition(*node);
  } else if (node && (node->kind() != Node::Kind::kScalar || node->text() != "controllers")) {
    node->fail("must be controllers, {at_s: 5} or a condition");
  }
  if (until.kind == Until::Kind::kControllers && scenario.controllers.empty()) {
    (node ? *node : root)
        .fail("without controllers, 'until' must say when the scenario ends: {at_s: 5}, or a condition");
  }
  return until;
}

void read_times(const Node& root, Scenario& scenario) {
  if (root.find("speedup")) scenario.speedup = root.get("speedup").number({1e-3, 1e3, false});
  scenario.max_overruns = root.number_or("max_overruns", scenario.max_overruns, {0.0, 1.0, false});
  scenario.max_sim_s = root.number_or("max_sim_s", scenario.max_sim_s, kSomeSeconds);
  scenario.max_wall_s = root.number_or("max_wall_s", scenario.max_wall_s, kSomeSeconds);
  scenario.start_wall_s = root.number_or("start_wall_s", scenario.start_wall_s, kSomeSeconds);
  scenario.settle_s = root.number_or("settle_s", scenario.settle_s, kSeconds);
  scenario.check_every_ms = root.number_or("check_every_ms", scenario.check_every_ms, {0.0, 4000.0, true});
}

void read_basics(const Node& root, Scenario& scenario) {
  if (root.get("visum_scenario").integer() != 1)
    root.get("visum_scenario").fail("this program reads version 1");
  scenario.file = root.place().file;
  scenario.name = root.get("name").text();
  if (scenario.name.empty()) root.get("name").fail("must not be empty");
  const Node scene = root.get("scene");
  scenario.scene = (scene.folder() / scene.text()).lexically_normal();
  std::error_code error;  // set where the name is too long, or a folder on the way may not be entered
  const auto status = std::filesystem::status(scenario.scene, error);
  if (status.type() == std::filesystem::file_type::none)
    scene.fail("'" + scenario.scene.string() + "' cannot be read: " + error.message());
  if (!std::filesystem::is_regular_file(status))
    scene.fail("there is no file '" + scenario.scene.string() + "'");
  if (const auto clock = root.find("clock")) scenario.clock = clock->one_of({"realtime", "lockstep", "free"});
  if (const auto engine = root.find("engine")) scenario.engine = engine->text();
  if (const auto seed = root.find("seed")) scenario.seed = seed->integer(0);
  if (const auto parameters = root.find("parameters")) {
    if (parameters->kind() != Node::Kind::kMap) parameters->fail("must be a map of the scene's parameters");
    scenario.parameters = config::flow(*parameters);
  }
  if (const auto record = root.find("record")) {
    scenario.record = record->text();
    if (scenario.record.empty()) record->fail("must name a file");
  }
}

}  // namespace

ControllerSpec read_controller(const Node& node) {
  node.allow_only({"name", "command", "client", "joins", "shim", "gate", "period_ms", "wait_s", "on_timeout",
                   "exchanges", "through"});
  ControllerSpec controller;
  controller.place = node.place();
  controller.name = node.get("name").text();
  if (controller.name.empty()) node.get("name").fail("must not be empty");
  const Node command = node.get("command");
  if (command.kind() != Node::Kind::kList || command.size() == 0) {
    command.fail("must be a list: the program, then its arguments");
  }
  for (std::size_t i = 0; i < command.size(); ++i) {
    controller.command.push_back(command.at(i).text());
    if (const auto fault = find_fault(controller.command.back())) command.at(i).fail(*fault);
  }
  controller.client = node.text_or("client", controller.name);
  for (const char* ours : {Session::kName, Session::kWaiterName}) {
    if (controller.client == ours)
      node.fail("the client name '" + controller.client + "' is the runner's own");
  }
  if (const auto joins = node.find("joins")) controller.joins = joins->boolean();
  if (const auto exchanges = node.find("exchanges")) controller.exchanges = exchanges->boolean();
  controller.through = node.text_or("through", "");
  if (!controller.exchanges && !controller.through.empty())
    node.get("through").fail("not with 'exchanges: false'");
  read_step(node, controller);
  return controller;
}

Scenario read_scenario(const Node& file, std::size_t run) {
  if (file.kind() != Node::Kind::kMap) file.fail("a scenario is a map");
  const Sweep sweep(file);
  return read_scenario(file, sweep.point(run), sweep.given() ? run : 0);
}

Scenario read_scenario(const Node& file, const SweepPoint& point, std::size_t run) {
  if (file.kind() != Node::Kind::kMap) file.fail("a scenario is a map");
  file.allow_only({"visum_scenario", "name",      "description", "scene",        "parameters",
                   "clock",          "engine",    "seed",        "record",       "speedup",
                   "max_overruns",   "max_sim_s", "max_wall_s",  "start_wall_s", "settle_s",
                   "check_every_ms", "until",     "buses",       "controllers",  "timeline",
                   "checks",         "sweep",     "sampling",    "decide",       "search"});
  read_decide(file);
  read_search(file);
  config::ExpansionBudget budget;
  const Node root = config::expanded(file, point.variables, budget);
  Scenario scenario;
  scenario.run = run;
  scenario.swept = point.described;
  read_basics(root, scenario);
  read_times(root, scenario);
  read_buses(root, scenario);
  read_controllers(root, scenario);
  check_buses(scenario);
  scenario.until = read_until(root, scenario);
  for (const Node& node : items(root, "timeline")) {
    scenario.timeline.push_back(read_timeline_entry(node, scenario.controllers));
  }
  for (const Node& node : items(root, "checks")) scenario.checks.push_back(read_check(node));
  return scenario;
}

Scenario read_scenario(const std::filesystem::path& file) {
  return read_scenario(config::load_file(file));
}

}  // namespace visum::run

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <thread>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/json_writer.h"
#include "clients/visum/common/parameters.h"
#include "clients/visum/common/terminal.h"
#include "clients/visum/verbs/verbs.h"

namespace visum::cli {
namespace {

using protocol::ModuleDescription;
using protocol::ModuleEnd;
using protocol::ModuleList;
using protocol::ModulePart;
using protocol::ModuleVector;

const std::vector<std::string>& ports_of(const ModuleDescription& module, ModuleVector vector) {
  switch (vector) {
    case ModuleVector::kControllerInput:
      return module.controller_inputs;
    case ModuleVector::kControllerOutput:
      return module.controller_outputs;
    case ModuleVector::kSensorInput:
      return module.sensor_inputs;
    default:
      return module.sensor_outputs;
  }
}

const std::vector<double>& values_of(const protocol::ModuleState& state, ModuleVector vector) {
  switch (vector) {
    case ModuleVector::kControllerInput:
      return state.controller_inputs;
    case ModuleVector::kControllerOutput:
      return state.controller_outputs;
    case ModuleVector::kSensorInput:
      return state.sensor_inputs;
    default:
      return state.sensor_outputs;
  }
}

constexpr ModuleVector kVectors[] = {ModuleVector::kControllerInput, ModuleVector::kControllerOutput,
                                     ModuleVector::kSensorInput, ModuleVector::kSensorOutput};

// "motion/Arm/Ramp/Controller Input/Desired Angle 1". A port of a part that nobody has announced has its
// number.
std::string text_of(const ModuleEnd& end, const ModuleList& list) {
  std::string port = std::to_string(end.first);
  for (const ModulePart& part : list.parts) {
    if (part.announced.part != end.part) continue;
    for (const ModuleDescription& module : part.announced.modules)
      if (module.path == end.path && end.first < ports_of(module, end.vector).size())
        port = ports_of(module, end.vector)[end.first];
  }
  return end.part + "/" + (end.path.empty() ? "" : end.path + "/") + to_string(end.vector) + "/" + port;
}

std::string name_of(const ModuleDescription& module) {
  return module.path.substr(module.path.rfind('/') + 1);
}

std::string group_of(const ModuleDescription& module) {
  const auto slash = module.path.rfind('/');
  return slash == std::string::npos ? "" : module.path.substr(0, slash);
}

std::string path_of(const ModulePart& part, const ModuleDescription& module) {
  return part.announced.part + (module.path.empty() ? "" : "/" + module.path);
}

// With the values that were reported last.
std::vector<protocol::Parameter> parameters_of(const ModulePart& part, std::size_t module) {
  auto parameters = part.announced.modules[module].parameters;
  if (module >= part.reported.modules.size()) return parameters;
  const auto& values = part.reported.modules[module].parameters;
  for (std::size_t i = 0; i < values.size(); ++i) parameters.at(i).value = values[i];
  return parameters;
}

protocol::ModuleBlackboard blackboard_of(const ModulePart& part, std::size_t index) {
  const auto& states = part.reported.blackboards;
  if (index < states.size()) return states[index];
  return {part.announced.blackboards[index].elements};
}

class Modules : public Verb {
 public:
  void declare(CLI::App& app) override {
    app.add_option("PART", part_, "only this part of a controller");
    app.add_flag("--values", values_, "also the values of all ports and parameters");
    auto* hold = app.add_option(
        "--hold", hold_, "MODULE/PORT=VALUE: make a sensor input hold a value against its edge, for a test");
    app.add_option("--release", release_, "MODULE/PORT: let a sensor input follow its edge again")
        ->excludes(hold);
    app.add_option("--set", set_, "MODULE/PARAMETER=VALUE: change a parameter of a module")
        ->excludes("--hold")
        ->excludes("--release");
    add_link_options(app, link_);
    app.footer(
        "Prints the modules of controllers in MCA2's manner that are connected: their group and part, the "
        "period, "
        "what Control() and Sense() take, and the edges between them. A sensor input that holds a value for "
        "a "
        "test is marked.\n\nExamples:\n  visum modules\n  visum modules motion --values\n"
        "  visum modules motion --hold \"Arm/Supervisor/Part State=2\"\n"
        "  visum modules motion --release \"Arm/Supervisor/Part State\"\n"
        "  visum modules motion --set Arm/Trajectory/Speed=0.5");
  }

  int run() override {
    if (!set_.empty()) return set_parameter();
    const bool overrides = !hold_.empty() || !release_.empty();
    auto link = open_link(link_, overrides ? protocol::Role::kController : protocol::Role::kObserver);
    if (overrides) {
      link.request(wanted());
      if (link_.json) std::puts("{\"sent\":true}");
      return kDone;
    }
    const auto all = link.request_as<ModuleList>(protocol::ListModules{});
    const auto list = part_.empty() ? all : link.request_as<ModuleList>(protocol::ListModules{part_});
    std::fputs((link_.json ? json(list, all) : text(list, all)).c_str(), stdout);
    return kDone;
  }

 private:
  int set_parameter() const {
    if (part_.empty()) throw ExitError(kUsage, "modules: which PART is to change a parameter?");
    const auto equals = set_.find('=');
    if (equals == std::string::npos)
      throw ExitError(kUsage, "--set: '" + set_ + "' is no MODULE/PARAMETER=VALUE");
    const std::string place = set_.substr(0, equals), text = set_.substr(equals + 1);
    const auto slash = place.rfind('/');
    protocol::SetModuleParameter request{part_, slash == std::string::npos ? "" : place.substr(0, slash),
                                         place.substr(slash + 1), text};
    auto link = open_link(link_, protocol::Role::kController);
    if (const auto known = find(link.request_as<ModuleList>(protocol::ListModules{part_}), request))
      request.value = parse_value(*known, text);
    link.request(request);
    const bool in_force = comes_into_force(link, request);
    if (link_.json)
      std::puts(in_force ? "{\"sent\":true,\"in_force\":true}" : "{\"sent\":true,\"in_force\":false}");
    else if (!in_force)
      std::puts("sent; the part has not shown the new value within 2 s, because its cycle stands or waits");
    return kDone;
  }

  // The part's report says so. Looks for up to 2 s.
  static bool comes_into_force(protocol::Connection& link, const protocol::SetModuleParameter& wanted) {
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(2);
    while (std::chrono::steady_clock::now() < give_up) {
      const auto list = link.request_as<ModuleList>(protocol::ListModules{wanted.part});
      const auto parameter = find(list, wanted);
      if (parameter && parameter->value == wanted.value) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return false;
  }

  // The parameter with its reported value, in a list of one part.
  static std::optional<protocol::Parameter> find(const ModuleList& list,
                                                 const protocol::SetModuleParameter& wanted) {
    const auto& part = list.parts.at(0);
    for (std::size_t i = 0; i < part.announced.modules.size(); ++i) {
      if (part.announced.modules[i].path != wanted.path) continue;
      for (auto& parameter : parameters_of(part, i))
        if (parameter.name == wanted.name) return parameter;
    }
    return {};
  }

  protocol::OverrideModulePort wanted() const {
    if (part_.empty()) throw ExitError(kUsage, "modules: which PART is to hold or release a sensor input?");
    protocol::OverrideModulePort request{part_};
    request.release = hold_.empty();
    std::string place = request.release ? release_ : hold_;
    if (!request.release) {
      const auto equals = place.rfind('=');
      const auto value = equals == std::string::npos ? std::nullopt : number_of(place.substr(equals + 1));
      if (!value) throw ExitError(kUsage, "--hold: '" + hold_ + "' is no MODULE/PORT=VALUE");
      request.value = *value;
      place.resize(equals);
    }
    const auto slash = place.rfind('/');
    if (slash == std::string::npos) throw ExitError(kUsage, "'" + place + "' is no MODULE/PORT");
    request.path = place.substr(0, slash);
    request.port = place.substr(slash + 1);
    return request;
  }

  static std::optional<double> number_of(const std::string& text) {
    try {
      std::size_t end = 0;
      const double number = std::stod(text, &end);
      if (end == text.size()) return number;
    } catch (const std::logic_error&) {  // no number, or too large
    }
    return {};
  }

  std::string json(const ModuleList& list, const ModuleList& all) const {
    JsonWriter json;
    json.begin_object().key("modules").begin_array();
    for (const ModulePart& part : list.parts) {
      for (std::size_t i = 0; i < part.announced.modules.size(); ++i) write(json, part, i);
    }
    json.end_array().key("parts").begin_array();
    for (const ModulePart& part : list.parts) write_part(json, part);
    json.end_array().key("edges").begin_array();
    for (const ModulePart& part : list.parts) {
      for (const auto& edge : part.announced.edges) {
        json.begin_object().member("from", text_of(edge.from, all)).member("to", text_of(edge.to, all));
        json.member("count", edge.count).end_object();
      }
    }
    return json.end_array().end_object().text() + "\n";
  }

  void write(JsonWriter& json, const ModulePart& part, std::size_t index) const {
    const ModuleDescription& module = part.announced.modules[index];
    if (module.is_group && module.path.empty()) return;  // the part itself
    const bool known = index < part.reported.modules.size();
    const auto state = known ? part.reported.modules[index] : protocol::ModuleState{};
    json.begin_object().member("name", name_of(module)).member("group", group_of(module));
    json.member("part", part.announced.part).member("is_group", module.is_group);
    json.member("period_ms", 1e-6 * static_cast<double>(part.announced.period_ns));
    json.member("control_us", 1e-3 * static_cast<double>(state.control_ns));
    json.member("sense_us", 1e-3 * static_cast<double>(state.sense_ns)).key("held").begin_array();
    for (const auto held : state.overridden) json.value(module.sensor_inputs[held]);
    json.end_array().key("parameters");
    write_parameters(json, parameters_of(part, index));
    if (values_) write_values(json, module, state);
    json.end_object();
  }

  // The part's own parameters, and its blackboards.
  static void write_part(JsonWriter& json, const ModulePart& part) {
    json.begin_object().member("name", part.announced.part).member("client", part.client).key("parameters");
    const auto& modules = part.announced.modules;
    const auto own = std::ranges::find(modules, std::string(), &ModuleDescription::path);
    write_parameters(json, own == modules.end() ? std::vector<protocol::Parameter>()
                                                : parameters_of(part, own - modules.begin()));
    json.key("blackboards").begin_array();
    for (std::size_t i = 0; i < part.announced.blackboards.size(); ++i) {
      const auto& board = part.announced.blackboards[i];
      const auto state = blackboard_of(part, i);
      json.begin_object().member("name", board.name).member("content_type", board.content_type);
      json.member("element_size", board.element_size).member("elements", state.elements);
      json.member("capacity", board.capacity).member("writable", board.writable);
      json.member("generation", state.generation).end_object();
    }
    json.end_array().end_object();
  }

  static void write_values(JsonWriter& json, const ModuleDescription& module,
                           const protocol::ModuleState& state) {
    for (const ModuleVector vector : kVectors) {
      json.key(to_string(vector)).begin_object();
      const auto& values = values_of(state, vector);
      for (std::size_t i = 0; i < values.size(); ++i) json.member(ports_of(module, vector)[i], values[i]);
      json.end_object();
    }
  }

  std::string text(const ModuleList& list, const ModuleList& all) const {
    if (list.parts.empty()) return "no controller has announced modules\n";
    Table table;
    table.row({"MODULE", "PERIOD", "CONTROL", "SENSE", ""});
    std::string values, edges;
    for (const ModulePart& part : list.parts) {
      const auto& modules = part.announced.modules;
      for (std::size_t i = 0; i < modules.size(); ++i) {
        const bool known = i < part.reported.modules.size();
        add(table, values, part, modules[i], known ? part.reported.modules[i] : protocol::ModuleState{});
        add_parameters(values, part, i);
      }
      add_blackboards(values, part);
      for (const auto& edge : part.announced.edges) {
        const std::string more = edge.count == 1 ? "" : " (" + std::to_string(edge.count) + " ports)";
        edges += printable(text_of(edge.from, all) + " -> " + text_of(edge.to, all) + more) + "\n";
      }
    }
    return table.text() + (values_ ? values : edges);
  }

  static void add(Table& table, std::string& values, const ModulePart& part, const ModuleDescription& module,
                  const protocol::ModuleState& state) {
    const std::string path = path_of(part, module);
    std::string held;
    for (const auto port : state.overridden)
      held += (held.empty() ? "holds " : ", ") + module.sensor_inputs[port];
    table.row({path + (module.is_group ? "/" : ""), shown(1e-6, part.announced.period_ns) + " ms",
               shown(1e-3, state.control_ns) + " us", shown(1e-3, state.sense_ns) + " us", held});
    for (const ModuleVector vector : kVectors) {
      const auto& numbers = values_of(state, vector);
      for (std::size_t i = 0; i < numbers.size(); ++i)
        values += printable(path + "/" + to_string(vector) + "/" + ports_of(module, vector)[i]) + " " +
                  exact(numbers[i]) + "\n";
    }
  }

  static void add_parameters(std::string& values, const ModulePart& part, std::size_t index) {
    const std::string path = path_of(part, part.announced.modules[index]);
    for (const auto& parameter : parameters_of(part, index)) {
      const std::string unit = parameter.unit.empty() ? "" : " " + parameter.unit;
      values +=
          printable(path + "/Parameters/" + parameter.name + " " + to_text(parameter.value) + unit) + "\n";
    }
  }

  static void add_blackboards(std::string& values, const ModulePart& part) {
    for (std::size_t i = 0; i < part.announced.blackboards.size(); ++i) {
      const auto& board = part.announced.blackboards[i];
      values += printable(part.announced.part + "/Blackboards/" + board.name + " " + board.content_type +
                          ", " + std::to_string(blackboard_of(part, i).elements) + " x " +
                          std::to_string(board.element_size) + " bytes") +
                "\n";
    }
  }

  static std::string shown(double scale, std::int64_t ns) {
    return exact(std::round(10.0 * scale * static_cast<double>(ns)) / 10.0);
  }

  LinkOptions link_;
  std::string part_, hold_, release_, set_;
  bool values_ = false;
};

}  // namespace

std::unique_ptr<Verb> make_modules() {
  return std::make_unique<Modules>();
}

}  // namespace visum::cli

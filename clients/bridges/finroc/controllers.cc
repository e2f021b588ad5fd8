#include "clients/bridges/finroc/controllers.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>

#include "clients/bridges/finroc/settings.h"
#include "protocol/config/number_text.h"
#include "protocol/module_board.h"

namespace visum::finroc {
namespace {

using protocol::ModuleVector;

constexpr std::chrono::milliseconds kEvery{40};
constexpr std::array<ModuleVector, 4> kVectorsInOrder{
    ModuleVector::kControllerInput, ModuleVector::kControllerOutput, ModuleVector::kSensorInput,
    ModuleVector::kSensorOutput};

std::size_t place_of(ModuleVector vector) {
  return static_cast<std::size_t>(vector) - 1;
}

const std::vector<std::string>& names_of(const protocol::ModuleDescription& module, std::size_t vector) {
  const std::array lists{&module.controller_inputs, &module.controller_outputs, &module.sensor_inputs,
                         &module.sensor_outputs};
  return *lists.at(vector);
}

const std::vector<double>& values_of(const protocol::ModuleState& state, std::size_t vector) {
  const std::array lists{&state.controller_inputs, &state.controller_outputs, &state.sensor_inputs,
                         &state.sensor_outputs};
  return *lists.at(vector);
}

std::size_t elements_of(const protocol::AnnounceModules& announced) {
  constexpr std::size_t kBesidePorts = 11;  // the module, its interfaces, and the bridge's own ports
  constexpr std::size_t kOfABlackboard = 2;
  std::size_t count = 1 + kOfABlackboard * announced.blackboards.size();
  for (const auto& module : announced.modules) {
    count += kBesidePorts + module.parameters.size();
    for (std::size_t v = 0; v < kVectorsInOrder.size(); ++v) count += names_of(module, v).size();
  }
  return count;
}

std::string parent_path(const std::string& path) {
  const auto slash = path.rfind('/');
  return slash == std::string::npos ? "" : path.substr(0, slash);
}

}  // namespace

Controllers::Controllers(bridge::Plant& plant, Board& board, FindPort find_hardware_port)
    : plant_(plant), board_(board), find_hardware_port_(std::move(find_hardware_port)) {}

void Controllers::refresh(std::chrono::steady_clock::time_point now, std::int64_t time_ns) {
  if (refreshed_ && now - *refreshed_ < kEvery) return;
  refreshed_ = now;
  const auto list = plant_.modules(revision_);
  if (list.revision != revision_) show(list);
  revision_ = list.revision;
  for (const auto& part : list.parts) {
    set_values(part, time_ns);
    set_blackboards(part, time_ns);
  }
}

void Controllers::show(const protocol::ModuleList& list) {
  for (const ElementId root : roots_) board_.remove(root);
  roots_.clear();
  shown_.clear();
  announced_.clear();
  inputs_.clear();
  releases_.clear();
  parameters_.clear();
  boards_.clear();
  std::size_t wanted = 0;
  for (const auto& part : list.parts) wanted += elements_of(part.announced);
  if (board_.elements().size() + wanted > kMostElements) {
    spdlog::warn(
        "the modules of controllers are not shown: they have come and gone too often; start the bridge anew");
    return;
  }
  for (const auto& part : list.parts) add_part(part.announced);
  for (const auto& part : list.parts) add_edges(part.announced);
}

void Controllers::add_part(const protocol::AnnounceModules& announced) {
  auto& shown = shown_[announced.part];
  announced_[announced.part] = announced;
  std::map<std::string, ElementId> elements;  // by path
  for (const auto& module : announced.modules) {
    const std::string name =
        module.path.empty() ? announced.part : module.path.substr(module.path.rfind('/') + 1);
    const auto above = elements.find(parent_path(module.path));
    const bool is_top = module.path.empty() || above == elements.end();
    const ElementId parent = is_top ? kRoot : above->second;
    const ElementId element =
        module.is_group ? board_.add_group(parent, name) : board_.add_module(parent, name);
    if (is_top) roots_.push_back(element);
    elements[module.path] = element;
    shown.push_back(add_module(element, announced, module));
    if (module.path.empty()) add_blackboards(element, announced);
  }
}

Controllers::Shown Controllers::add_module(ElementId element, const protocol::AnnounceModules& announced,
                                           const protocol::ModuleDescription& module) {
  Shown shown;
  for (std::size_t v = 0; v < kVectors; ++v) {
    const auto& names = names_of(module, v);
    if (names.empty()) continue;
    const bool senses = v >= place_of(ModuleVector::kSensorInput);
    const ElementId interface = board_.add_interface(element, protocol::to_string(kVectorsInOrder[v]),
                                                     senses ? flag::kSensorData : flag::kControllerData);
    const bool may_hold = !module.is_group && kVectorsInOrder[v] == ModuleVector::kSensorInput;
    shown.first[v] = static_cast<ElementId>(board_.elements().size());
    shown.count[v] = names.size();
    for (const auto& name : names) {
      const ElementId id =
          board_.add_port(interface, name, number_type(), may_hold ? Access::kWrite : Access::kRead, 0.0);
      if (may_hold) inputs_[id] = {announced.part, module.path, name};
    }
  }
  add_parameters(shown, element, announced.part, module);
  if (module.is_group) return shown;
  const ElementId profile = board_.add_interface(element, "Profile", flag::kSensorData);
  shown.control_time =
      board_.add_port(profile, "Control Time", number_type(), Access::kRead, 0.0, unit_code("s"));
  shown.sense_time =
      board_.add_port(profile, "Sense Time", number_type(), Access::kRead, 0.0, unit_code("s"));
  shown.held =
      board_.add_port(profile, "Held For Test", {Kind::kText, "String", {}}, Access::kRead, std::string());
  return shown;
}

void Controllers::add_parameters(Shown& shown, ElementId element, const std::string& part,
                                 const protocol::ModuleDescription& module) {
  if (module.is_group && module.parameters.empty()) return;
  const ElementId interface = board_.add_interface(element, "Parameters", 0);
  shown.first_parameter = static_cast<ElementId>(board_.elements().size());
  const std::string owner = part + "/" + module.path;
  for (const auto& parameter : module.parameters) {
    const Type type = choice_or_text(owner, parameter);
    const ElementId id =
        board_.add_port(interface, parameter.name, type, parameter.read_only ? Access::kRead : Access::kWrite,
                        to_board(type, parameter.value), unit_code(parameter.unit));
    parameters_[id] = {part, module.path, parameter.name};
  }
  if (module.is_group) return;
  const ElementId release =
      board_.add_port(interface, "Release Held", {Kind::kBool, "bool", {}}, Access::kWrite, false);
  releases_[release] = {part, module.path, {}};
}

// A peer hears a list of choices once. A part that comes back with another list is shown by texts.
Type Controllers::choice_or_text(const std::string& owner, const protocol::Parameter& parameter) {
  const Type type = setting_type(owner, parameter.name, parameter.value, parameter.choices);
  if (type.kind != Kind::kChoice) return type;
  return choices_.try_emplace(type.name, type.choices).first->second == type.choices ? type : text_type();
}

void Controllers::add_blackboards(ElementId top, const protocol::AnnounceModules& announced) {
  if (announced.blackboards.empty()) return;
  const ElementId folder = board_.add_plain(top, "Blackboards");
  for (const auto& board : announced.blackboards) {
    const ElementId read = board_.add_port(board_.add_plain(folder, board.name), "read", text_type(),
                                           Access::kRead, std::string());
    boards_[announced.part].push_back(read);
  }
}

std::optional<ElementId> Controllers::port_of(const protocol::ModuleEnd& end, std::size_t offset) const {
  const std::size_t index = end.first + offset;
  const auto part = announced_.find(end.part);
  if (part == announced_.end()) return find_hardware_port_(end.part, end.vector, index);
  const auto& modules = part->second.modules;
  const auto module = std::ranges::find(modules, end.path, &protocol::ModuleDescription::path);
  if (module == modules.end()) return {};
  const Shown& shown = shown_.at(end.part)[static_cast<std::size_t>(module - modules.begin())];
  const std::size_t vector = place_of(end.vector);
  if (index >= shown.count[vector]) return {};
  return shown.first[vector] + static_cast<ElementId>(index);
}

void Controllers::add_edges(const protocol::AnnounceModules& announced) {
  for (const auto& edge : announced.edges) {
    for (std::size_t i = 0; i < std::min<std::size_t>(edge.count, protocol::ModuleBoard::kMostPorts); ++i) {
      const auto from = port_of(edge.from, i), to = port_of(edge.to, i);
      if (from && to) board_.add_edge(*from, *to);
    }
  }
}

void Controllers::set_values(const protocol::ModulePart& part, std::int64_t time_ns) {
  const auto shown = shown_.find(part.reported.part);
  const auto announced = announced_.find(part.reported.part);
  if (shown == shown_.end() || shown->second.size() != part.reported.modules.size()) return;
  for (std::size_t m = 0; m < shown->second.size(); ++m) {
    const Shown& module = shown->second[m];
    const auto& state = part.reported.modules[m];
    const auto& description = announced->second.modules[m];
    for (std::size_t p = 0; p < std::min(state.parameters.size(), description.parameters.size()); ++p) {
      const ElementId id = module.first_parameter + static_cast<ElementId>(p);
      board_.set(id, to_board(board_.elements()[id].type, state.parameters[p]), time_ns);
    }
    for (std::size_t v = 0; v < kVectors; ++v) {
      const auto& values = values_of(state, v);
      for (std::size_t i = 0; i < std::min(values.size(), module.count[v]); ++i)
        board_.set(module.first[v] + static_cast<ElementId>(i), values[i], time_ns);
    }
    if (description.is_group) continue;
    board_.set(module.control_time, 1e-9 * static_cast<double>(state.control_ns), time_ns);
    board_.set(module.sense_time, 1e-9 * static_cast<double>(state.sense_ns), time_ns);
    auto& held = held_[part.reported.part + "/" + description.path];
    held.clear();
    std::string text;
    for (const auto port : state.overridden) {
      if (port >= description.sensor_inputs.size() || port >= state.sensor_inputs.size()) continue;
      held.push_back(description.sensor_inputs[port]);
      text +=
          (text.empty() ? "" : ", ") + held.back() + " = " + config::number_text(state.sensor_inputs[port]);
    }
    board_.set(module.held, text, time_ns);
  }
}

void Controllers::set_blackboards(const protocol::ModulePart& part, std::int64_t time_ns) {
  const auto boards = boards_.find(part.reported.part);
  if (boards == boards_.end()) return;
  const auto& described = announced_.at(part.reported.part).blackboards;
  for (std::size_t i = 0; i < std::min(boards->second.size(), part.reported.blackboards.size()); ++i) {
    const auto& state = part.reported.blackboards[i];
    const auto& [name, content_type, row_bytes, rows, capacity, writable] = described[i];
    board_.set(boards->second[i], shown(content_type, row_bytes, state.head, row_bytes * state.elements),
               time_ns);
  }
}

std::string Controllers::write(ElementId id, const Value& value) {
  if (const auto input = inputs_.find(id); input != inputs_.end()) {
    const auto& [part, path, port] = input->second;
    return plant_.override_module({part, path, port, as_double(value), false});
  }
  if (const auto parameter = parameters_.find(id); parameter != parameters_.end()) {
    const auto& [part, path, name] = parameter->second;
    return plant_.set_module_parameter({part, path, name, to_server(board_.elements()[id], value)});
  }
  const auto release = releases_.find(id);
  if (release == releases_.end()) return "this port is an output of a module";
  if (as_double(value) == 0.0) return {};
  const auto& [part, path, none] = release->second;
  for (const auto& port : held_[part + "/" + path]) {
    if (std::string why = plant_.override_module({part, path, port, 0.0, true}); !why.empty()) return why;
  }
  return {};
}

}  // namespace visum::finroc

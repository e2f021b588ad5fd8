#include "protocol/module_board.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "protocol/config/printable.h"
#include "protocol/config/unknown_name.h"

namespace visum::protocol {
namespace {

using Text = std::optional<std::string>;

// The widths of a vector's ports in a description.
std::size_t width_of(const ModuleDescription& module, ModuleVector vector) {
  switch (vector) {
    case ModuleVector::kControllerInput:
      return module.controller_inputs.size();
    case ModuleVector::kControllerOutput:
      return module.controller_outputs.size();
    case ModuleVector::kSensorInput:
      return module.sensor_inputs.size();
    case ModuleVector::kSensorOutput:
      return module.sensor_outputs.size();
    case ModuleVector::kUnspecified:
      break;
  }
  return 0;
}

std::size_t ports_of(const ModuleDescription& module) {
  return module.controller_inputs.size() + module.controller_outputs.size() + module.sensor_inputs.size() +
         module.sensor_outputs.size();
}

const ModuleDescription* find(const AnnounceModules& announced, const std::string& path) {
  const auto found = std::ranges::find(announced.modules, path, &ModuleDescription::path);
  return found == announced.modules.end() ? nullptr : &*found;
}

// The module that an order names; null: `refusal` says why there is none.
const ModuleDescription* find_module(const AnnounceModules& announced, const std::string& path, bool or_group,
                                     ModuleBoard::Refusal& refusal) {
  const ModuleDescription* module = find(announced, path);
  if (module != nullptr && (or_group || !module->is_group)) return module;
  std::vector<std::string> paths;
  for (const auto& known : announced.modules)
    if (or_group || !known.is_group) paths.push_back(known.path);
  refusal = {{ErrorCode::kUnknownName, config::unknown_name("module", path, paths)}};
  return nullptr;
}

bool is_name(const std::string& text) {
  return text.size() <= ModuleBoard::kMostNameBytes && config::printable(text) == text;
}

bool is_short(const ParameterValue& value) {
  const auto* text = std::get_if<std::string>(&value);
  return text == nullptr || text->size() <= ModuleBoard::kMostTextBytes;
}

Text refuse_parameter(const Parameter& parameter) {
  const auto& [name, unit, help, value, minimum, maximum, choices, read_only] = parameter;
  if (name.empty() || !is_name(name) || !is_name(unit) || !std::ranges::all_of(choices, is_name))
    return "its name, unit or choices are empty, too long, or hold control characters";
  if (help.size() > ModuleBoard::kMostTextBytes) return "its help is too long";
  if (std::isnan(minimum) || std::isnan(maximum)) return "its range is no range";
  if (!is_short(value)) return "its text is too long";
  return {};
}

Text refuse_parameters(const ModuleDescription& module) {
  std::set<std::string> names;
  for (const Parameter& parameter : module.parameters) {
    const std::string which =
        "the parameter '" + config::printable(parameter.name.substr(0, 64)) + "' of '" + module.path + "': ";
    if (const auto why = refuse_parameter(parameter)) return which + *why;
    if (!names.insert(parameter.name).second) return which + "it is there twice";
  }
  return {};
}

Text refuse_blackboards(const AnnounceModules& announced) {
  if (announced.blackboards.size() > ModuleBoard::kMostBlackboards)
    return "more than " + std::to_string(ModuleBoard::kMostBlackboards) + " blackboards";
  std::set<std::string> names;
  for (const Blackboard& board : announced.blackboards) {
    if (board.name.empty() || !is_name(board.name) || !is_name(board.content_type))
      return "a blackboard's name or content type is empty, too long, or holds control characters";
    if (!names.insert(board.name).second) return "the blackboard '" + board.name + "' is there twice";
  }
  return {};
}

Text refuse_modules(const AnnounceModules& announced) {
  std::set<std::string> paths;
  std::size_t ports = 0, parameters = 0;
  for (const ModuleDescription& module : announced.modules) {
    ports += ports_of(module);
    parameters += module.parameters.size();
    if (!is_name(module.path)) return "a module's path is too long or holds control characters";
    if (!paths.insert(module.path).second) return "the module '" + module.path + "' is there twice";
    for (const auto* names : {&module.controller_inputs, &module.controller_outputs, &module.sensor_inputs,
                              &module.sensor_outputs}) {
      if (!std::ranges::all_of(*names, is_name))
        return "a port of '" + module.path + "' has a name that is too long or holds control characters";
    }
    if (auto why = refuse_parameters(module)) return why;
  }
  if (parameters > ModuleBoard::kMostParameters)
    return "more than " + std::to_string(ModuleBoard::kMostParameters) + " parameters";
  if (ports > ModuleBoard::kMostPorts)
    return "more than " + std::to_string(ModuleBoard::kMostPorts) + " ports";
  return {};
}

// The modules of another part may not be known yet.
Text refuse_end(const AnnounceModules& announced, const ModuleEnd& end, std::uint32_t count) {
  if (end.vector == ModuleVector::kUnspecified) return "an edge names no vector";
  if (!is_name(end.part) || !is_name(end.path)) return "an edge names a part or module that cannot be";
  if (end.part != announced.part) return {};
  const ModuleDescription* module = find(announced, end.path);
  if (module == nullptr) return "an edge names the module '" + end.path + "', which is not announced";
  const std::size_t width = width_of(*module, end.vector);
  if (count == 0 || end.first > width || count > width - end.first)
    return "an edge goes beyond the " + std::string(to_string(end.vector)) + " of '" + end.path + "'";
  return {};
}

Text refuse_edges(const AnnounceModules& announced) {
  for (const ModuleEdge& edge : announced.edges) {
    if (auto why = refuse_end(announced, edge.from, edge.count)) return why;
    if (auto why = refuse_end(announced, edge.to, edge.count)) return why;
  }
  return {};
}

bool fits(const ModuleDescription& module, const ModuleState& state) {
  return state.controller_inputs.size() == module.controller_inputs.size() &&
         state.controller_outputs.size() == module.controller_outputs.size() &&
         state.sensor_inputs.size() == module.sensor_inputs.size() &&
         state.sensor_outputs.size() == module.sensor_outputs.size() &&
         std::ranges::all_of(state.overridden,
                             [&](std::uint32_t i) { return i < module.sensor_inputs.size(); }) &&
         std::ranges::equal(module.parameters, state.parameters,
                            [](const Parameter& parameter, const ParameterValue& value) {
                              return value.index() == parameter.value.index() && is_short(value);
                            });
}

bool fits(const AnnounceModules& announced, const ReportModules& reported) {
  return std::ranges::equal(announced.modules, reported.modules,
                            [](const auto& module, const auto& state) { return fits(module, state); }) &&
         announced.blackboards.size() == reported.blackboards.size() &&
         std::ranges::all_of(reported.blackboards, [](const ModuleBlackboard& board) {
           return board.head.size() <= ModuleBoard::kMostHeadBytes;
         });
}

}  // namespace

Text ModuleBoard::check(const AnnounceModules& announced) {
  if (announced.part.empty() || announced.part.size() > 64 ||
      config::printable(announced.part) != announced.part)
    return "part must have 1 to 64 bytes, and no control characters";
  if (!is_name(announced.address)) return "address is too long or holds control characters";
  if (announced.period_ns < 0) return "period_ns must not be negative";
  if (announced.modules.size() > ModuleBoard::kMostModules)
    return "more than " + std::to_string(ModuleBoard::kMostModules) + " modules";
  if (announced.edges.size() > ModuleBoard::kMostEdges)
    return "more than " + std::to_string(ModuleBoard::kMostEdges) + " edges";
  if (auto why = refuse_modules(announced)) return why;
  if (auto why = refuse_blackboards(announced)) return why;
  return refuse_edges(announced);
}

ModuleBoard::Refusal ModuleBoard::announce(std::uint64_t session, const std::string& client,
                                           const AnnounceModules& announced) {
  if (auto why = check(announced)) return {{ErrorCode::kBadValue, *why}};
  const auto known = parts_.find(announced.part);
  if (known != parts_.end() && known->second.session != session)
    return {{ErrorCode::kWrongState, "the part '" + announced.part + "' is announced by '" +
                                         known->second.part.client + "' already"}};
  if (known == parts_.end() && parts_.size() >= kMostParts)
    return {{ErrorCode::kBusy, "more than " + std::to_string(kMostParts) + " parts are announced"}};
  ++revision_;
  if (announced.modules.empty()) {
    parts_.erase(announced.part);
  } else {
    parts_[announced.part] = {session, {client, announced, {announced.part}}};
  }
  return {};
}

ModuleBoard::Refusal ModuleBoard::report(std::uint64_t session, const ReportModules& reported) {
  const auto found = parts_.find(reported.part);
  if (found == parts_.end() || found->second.session != session)
    return {{ErrorCode::kWrongState, "this session has not announced the part '" + reported.part + "'"}};
  if (!fits(found->second.part.announced, reported))
    return {{ErrorCode::kBadValue, "the values of '" + reported.part + "' do not fit what was announced"}};
  found->second.part.reported = reported;
  return {};
}

std::vector<std::string> ModuleBoard::forget(std::uint64_t session) {
  std::vector<std::string> names;
  for (const auto& [name, entry] : parts_)
    if (entry.session == session) names.push_back(name);
  for (const auto& name : names) parts_.erase(name);
  if (!names.empty()) ++revision_;
  return names;
}

ModuleBoard::Refusal ModuleBoard::check(const ListModules& request) const {
  if (request.part.empty() || parts_.contains(request.part)) return {};
  std::vector<std::string> names;
  for (const auto& [name, entry] : parts_) names.push_back(name);
  return {{ErrorCode::kUnknownName, config::unknown_name("part of a controller", request.part, names)}};
}

ModuleList ModuleBoard::list(const ListModules& request) const {
  ModuleList list{revision_};
  for (const auto& [name, entry] : parts_) {
    if (!request.part.empty() && request.part != name) continue;
    list.parts.push_back(entry.part);
    if (request.known_revision == revision_) list.parts.back().announced = {name};
  }
  return list;
}

const ModuleBoard::Entry* ModuleBoard::find(const std::string& part, Refusal& refusal) const {
  refusal = check(ListModules{part});
  if (part.empty()) refusal = {{ErrorCode::kBadValue, "no part is named"}};
  return refusal ? nullptr : &parts_.at(part);
}

std::optional<std::uint64_t> ModuleBoard::target_of(const OverrideModulePort& request,
                                                    Refusal& refusal) const {
  const Entry* entry = find(request.part, refusal);
  if (entry == nullptr) return {};
  const auto* module = find_module(entry->part.announced, request.path, false, refusal);
  if (module == nullptr) return {};
  if (std::ranges::find(module->sensor_inputs, request.port) == module->sensor_inputs.end()) {
    refusal = {
        {ErrorCode::kUnknownName, config::unknown_name("sensor input", request.port, module->sensor_inputs)}};
    return {};
  }
  if (!std::isfinite(request.value)) {
    refusal = {{ErrorCode::kBadValue, "the value must be a finite number"}};
    return {};
  }
  return entry->session;
}

std::optional<std::uint64_t> ModuleBoard::target_of(const SetModuleParameter& request,
                                                    Refusal& refusal) const {
  const Entry* entry = find(request.part, refusal);
  if (entry == nullptr) return {};
  const auto* module = find_module(entry->part.announced, request.path, true, refusal);
  if (module == nullptr) return {};
  const auto parameter = std::ranges::find(module->parameters, request.name, &Parameter::name);
  if (parameter == module->parameters.end()) {
    std::vector<std::string> names;
    for (const Parameter& known : module->parameters) names.push_back(known.name);
    refusal = {{ErrorCode::kUnknownName, config::unknown_name("parameter", request.name, names)}};
    return {};
  }
  ParameterValue value = request.value;
  std::string why = refuse_value(*parameter, value);
  if (parameter->read_only) why = "'" + request.name + "' is read-only";
  if (!is_short(value)) why = "a text has at most " + std::to_string(kMostTextBytes) + " bytes";
  if (!why.empty()) {
    refusal = {{ErrorCode::kBadValue, why}};
    return {};
  }
  return entry->session;
}

}  // namespace visum::protocol

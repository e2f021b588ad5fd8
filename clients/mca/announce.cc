#include "clients/mca/announce.h"

#include <algorithm>

#include "clients/mca/part.h"
#include "protocol/module_board.h"

namespace visum::mca {
namespace {

using protocol::ModuleBoard;

// Calls `visit` for a module and all below it, a group before its members.
template <typename Visit>
void for_each(Module& module, const Visit& visit) {
  visit(module);
  if (auto* group = dynamic_cast<Group*>(&module))
    for (const auto& member : group->members()) for_each(*member, visit);
}

protocol::ModuleEnd end_of(const std::string& part, const Vector& vector, std::size_t first) {
  return {part, vector.owner()->path(), vector.kind(), static_cast<std::uint32_t>(first)};
}

// The end of an edge in the part below.
protocol::ModuleEnd end_below(const Lower& lower, const Vector& vector, std::size_t first) {
  return {lower.part_name(), {}, vector.kind(), static_cast<std::uint32_t>(first)};
}

std::vector<protocol::Parameter> parameters_of(const Module& module) {
  std::vector<protocol::Parameter> parameters;
  for (const ParameterBase* parameter : module.parameters()) {
    parameters.push_back(parameter->description());
    parameters.back().name = parameter->name();  // the path stands beside it
  }
  return parameters;
}

protocol::ModuleBlackboard state_of(const Blackboard& board) {
  const auto head = board.bytes().first(std::min(board.bytes().size(), ModuleBoard::kMostHeadBytes));
  return {board.rows(), board.generation(), {head.begin(), head.end()}};
}

protocol::ModuleState state_of(Module& module) {
  protocol::ModuleState state{module.controller_input().values(), module.controller_output().values(),
                              module.sensor_input().values(),     module.sensor_output().values(),
                              module.control_time().mean_ns(),    module.sense_time().mean_ns()};
  for (const auto& [index, value] : module.sensor_input().held())
    state.overridden.push_back(static_cast<std::uint32_t>(index));
  for (const ParameterBase* parameter : module.parameters()) state.parameters.push_back(parameter->value());
  return state;
}

}  // namespace

protocol::AnnounceModules describe(Part& part, const std::vector<std::unique_ptr<Lower>>& lower,
                                   const std::string& address) {
  protocol::AnnounceModules announced{part.name(), part.options().period_ns};
  announced.address = address;
  for (const Blackboard* board : part.blackboards()) announced.blackboards.push_back(board->description());
  for_each(part, [&](Module& module) {
    const auto* group = dynamic_cast<const Group*>(&module);
    announced.modules.push_back({module.path(), group != nullptr, module.controller_input().names(),
                                 module.controller_output().names(), module.sensor_input().names(),
                                 module.sensor_output().names(), parameters_of(module)});
    if (group == nullptr) return;
    for (const Edge& edge : group->edges())
      announced.edges.push_back({end_of(part.name(), *edge.from, edge.first_from),
                                 end_of(part.name(), *edge.to, edge.first_to),
                                 static_cast<std::uint32_t>(edge.count)});
  });
  for (const auto& below : lower) {
    for (const Edge& edge : below->edges()) {
      const bool down = edge.to->owner() == nullptr;
      announced.edges.push_back(
          {down ? end_of(part.name(), *edge.from, edge.first_from)
                : end_below(*below, *edge.from, edge.first_from),
           down ? end_below(*below, *edge.to, edge.first_to) : end_of(part.name(), *edge.to, edge.first_to),
           static_cast<std::uint32_t>(edge.count)});
    }
  }
  return announced;
}

protocol::ReportModules values_of(Part& part) {
  protocol::ReportModules reported{part.name(), part.LoopTime()};
  for_each(part, [&](Module& module) { reported.modules.push_back(state_of(module)); });
  for (const Blackboard* board : part.blackboards()) reported.blackboards.push_back(state_of(*board));
  return reported;
}

protocol::ReportModules largest_values_of(Part& part) {
  auto reported = values_of(part);
  for (auto& module : reported.modules) {
    for (auto& value : module.parameters)
      if (std::holds_alternative<std::string>(value)) value = std::string(ModuleBoard::kMostTextBytes, 'x');
  }
  for (auto& board : reported.blackboards) board.head.resize(ModuleBoard::kMostHeadBytes);
  return reported;
}

Module* find_module(Part& part, const std::string& path) {
  Module* found = nullptr;
  for_each(part, [&](Module& module) {
    if (module.path() == path) found = &module;
  });
  return found;
}

}  // namespace visum::mca

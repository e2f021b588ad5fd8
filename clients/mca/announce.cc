#include "clients/mca/announce.h"

#include "clients/mca/part.h"

namespace visum::mca {
namespace {

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

protocol::ModuleState state_of(Module& module) {
  protocol::ModuleState state{module.controller_input().values(), module.controller_output().values(),
                              module.sensor_input().values(),     module.sensor_output().values(),
                              module.control_time().mean_ns(),    module.sense_time().mean_ns()};
  for (const auto& [index, value] : module.sensor_input().held())
    state.overridden.push_back(static_cast<std::uint32_t>(index));
  return state;
}

}  // namespace

protocol::AnnounceModules describe(Part& part, const std::vector<std::unique_ptr<Lower>>& lower,
                                   const std::string& address) {
  protocol::AnnounceModules announced{part.name(), part.options().period_ns};
  announced.address = address;
  for_each(part, [&](Module& module) {
    const auto* group = dynamic_cast<const Group*>(&module);
    announced.modules.push_back({module.path(), group != nullptr, module.controller_input().names(),
                                 module.controller_output().names(), module.sensor_input().names(),
                                 module.sensor_output().names()});
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

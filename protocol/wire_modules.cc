// Modules, groups and edges of controllers: the requests about them, and the list of them. Locks of
// blackboards stand here, too.
#include "protocol/wire.h"
#include "visum.pb.h"

namespace visum::protocol::wire {
namespace {

void put_end(const ModuleEnd& from, v1::ModuleEnd& to) {
  to.set_part(from.part);
  to.set_path(from.path);
  to.set_vector(static_cast<v1::ModuleVector>(from.vector));
  to.set_first(from.first);
}

bool take_end(const v1::ModuleEnd& from, ModuleEnd& to, std::string& why) {
  to.part = from.part();
  to.path = from.path();
  to.first = from.first();
  return take_enum(from.vector(), ModuleVector::kSensorOutput, to.vector, "vector", why);
}

void put_announced(const AnnounceModules& from, v1::AnnounceModules& to) {
  to.set_part(from.part);
  to.set_period_ns(from.period_ns);
  to.set_address(from.address);
  for (const ModuleDescription& module : from.modules) {
    auto& w = *to.add_modules();
    w.set_path(module.path);
    w.set_is_group(module.is_group);
    put_texts(module.controller_inputs, w.mutable_controller_inputs());
    put_texts(module.controller_outputs, w.mutable_controller_outputs());
    put_texts(module.sensor_inputs, w.mutable_sensor_inputs());
    put_texts(module.sensor_outputs, w.mutable_sensor_outputs());
    for (const Parameter& parameter : module.parameters) wire::put(parameter, *w.add_parameters());
  }
  for (const Blackboard& board : from.blackboards) wire::put(board, *to.add_blackboards());
  for (const ModuleEdge& edge : from.edges) {
    auto& w = *to.add_edges();
    put_end(edge.from, *w.mutable_from());
    put_end(edge.to, *w.mutable_to());
    w.set_count(edge.count);
  }
}

bool take_announced(const v1::AnnounceModules& from, AnnounceModules& to, std::string& why) {
  to.part = from.part();
  to.period_ns = from.period_ns();
  to.address = from.address();
  for (const auto& w : from.modules()) {
    to.modules.push_back({w.path(), w.is_group(), texts_of(w.controller_inputs()),
                          texts_of(w.controller_outputs()), texts_of(w.sensor_inputs()),
                          texts_of(w.sensor_outputs())});
    for (const auto& parameter : w.parameters())
      if (!wire::take(parameter, to.modules.back().parameters.emplace_back(), why)) return false;
  }
  for (const auto& w : from.blackboards()) to.blackboards.push_back(blackboard_of(w));
  for (const auto& w : from.edges()) {
    ModuleEdge& edge = to.edges.emplace_back();
    edge.count = w.count();
    if (!take_end(w.from(), edge.from, why) || !take_end(w.to(), edge.to, why)) return false;
  }
  return true;
}

void put_reported(const ReportModules& from, v1::ReportModules& to) {
  to.set_part(from.part);
  to.set_time_ns(from.time_ns);
  for (const ModuleState& module : from.modules) {
    auto& w = *to.add_modules();
    put_numbers(module.controller_inputs, w.mutable_controller_inputs());
    put_numbers(module.controller_outputs, w.mutable_controller_outputs());
    put_numbers(module.sensor_inputs, w.mutable_sensor_inputs());
    put_numbers(module.sensor_outputs, w.mutable_sensor_outputs());
    w.set_control_ns(module.control_ns);
    w.set_sense_ns(module.sense_ns);
    put_numbers(module.overridden, w.mutable_overridden());
    for (const ParameterValue& value : module.parameters) wire::put(value, *w.add_parameters());
  }
  for (const ModuleBlackboard& board : from.blackboards) {
    auto& w = *to.add_blackboards();
    w.set_elements(board.elements);
    w.set_generation(board.generation);
    w.set_head(bytes_of(board.head));
  }
}

bool take_reported(const v1::ReportModules& from, ReportModules& to, std::string& why) {
  to.part = from.part();
  to.time_ns = from.time_ns();
  for (const auto& w : from.modules()) {
    ModuleState& module = to.modules.emplace_back();
    take_numbers(w.controller_inputs(), module.controller_inputs);
    take_numbers(w.controller_outputs(), module.controller_outputs);
    take_numbers(w.sensor_inputs(), module.sensor_inputs);
    take_numbers(w.sensor_outputs(), module.sensor_outputs);
    module.control_ns = w.control_ns();
    module.sense_ns = w.sense_ns();
    take_numbers(w.overridden(), module.overridden);
    for (const auto& value : w.parameters())
      if (!wire::take(value, module.parameters.emplace_back(), why)) return false;
  }
  for (const auto& w : from.blackboards())
    to.blackboards.push_back({w.elements(), w.generation(), bytes_of(w.head())});
  return true;
}

}  // namespace

void PutModuleRequest::operator()(const AnnounceModules& from) const {
  put_announced(from, *to.mutable_announce_modules());
}
void PutModuleRequest::operator()(const ReportModules& from) const {
  put_reported(from, *to.mutable_report_modules());
}
void PutModuleRequest::operator()(const ListModules& from) const {
  to.mutable_list_modules()->set_part(from.part);
  to.mutable_list_modules()->set_known_revision(from.known_revision);
}
void PutModuleRequest::operator()(const OverrideModulePort& from) const {
  put_override(from, *to.mutable_override_module_port());
}
void PutModuleRequest::operator()(const SetModuleParameter& from) const {
  wire::put(from, *to.mutable_set_module_parameter());
}

void PutModuleRequest::operator()(const LockBlackboard& from) const {
  auto& w = *to.mutable_lock_blackboard();
  w.set_part(from.part);
  w.set_name(from.name);
  w.set_timeout_ns(from.timeout_ns);
}
void PutModuleRequest::operator()(const UnlockBlackboard& from) const {
  auto& w = *to.mutable_unlock_blackboard();
  w.set_part(from.part);
  w.set_name(from.name);
  w.set_discard(from.discard);
}

bool take_module_request(const v1::ClientMessage& from, Request& to, std::string& why) {
  switch (from.request_case()) {
    case v1::ClientMessage::kAnnounceModules:
      return take_announced(from.announce_modules(), to.emplace<AnnounceModules>(), why);
    case v1::ClientMessage::kReportModules:
      return take_reported(from.report_modules(), to.emplace<ReportModules>(), why);
    case v1::ClientMessage::kListModules:
      to = ListModules{from.list_modules().part(), from.list_modules().known_revision()};
      return true;
    case v1::ClientMessage::kOverrideModulePort:
      to = override_of(from.override_module_port());
      return true;
    case v1::ClientMessage::kSetModuleParameter:
      return wire::take(from.set_module_parameter(), to.emplace<SetModuleParameter>(), why);
    case v1::ClientMessage::kLockBlackboard:
      to = LockBlackboard{from.lock_blackboard().part(), from.lock_blackboard().name(),
                          from.lock_blackboard().timeout_ns()};
      return true;
    case v1::ClientMessage::kUnlockBlackboard:
      to = UnlockBlackboard{from.unlock_blackboard().part(), from.unlock_blackboard().name(),
                            from.unlock_blackboard().discard()};
      return true;
    default:
      return false;
  }
}

void put(const SetModuleParameter& from, v1::SetModuleParameter& to) {
  to.set_part(from.part);
  to.set_path(from.path);
  to.set_name(from.name);
  wire::put(from.value, *to.mutable_value());
}

bool take(const v1::SetModuleParameter& from, SetModuleParameter& to, std::string& why) {
  to.part = from.part();
  to.path = from.path();
  to.name = from.name();
  return wire::take(from.value(), to.value, why);
}

void put(const ModuleList& from, v1::ModuleList& to) {
  to.set_revision(from.revision);
  for (const ModulePart& part : from.parts) {
    auto& w = *to.add_parts();
    w.set_client(part.client);
    put_announced(part.announced, *w.mutable_announced());
    put_reported(part.reported, *w.mutable_reported());
  }
}

bool take(const v1::ModuleList& from, ModuleList& to, std::string& why) {
  to.revision = from.revision();
  for (const auto& w : from.parts()) {
    ModulePart& part = to.parts.emplace_back();
    part.client = w.client();
    if (!take_reported(w.reported(), part.reported, why)) return false;
    if (!take_announced(w.announced(), part.announced, why)) return false;
  }
  return true;
}

}  // namespace visum::protocol::wire

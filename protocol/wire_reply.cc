// ServerMessage: replies, samples, events.
#include <cstring>
#include <variant>

#include "protocol/wire.h"
#include "visum.pb.h"

namespace visum::protocol::wire {
namespace {

void put_event(const Event& from, v1::Event& to) {
  to.set_kind(from.kind);
  to.set_text(from.text);
  to.set_part(from.part);
  to.set_era(from.era);
  to.set_tick(from.tick);
  to.set_level(static_cast<v1::EventLevel>(from.level));
  to.set_source(from.source);
  to.set_sim_time_ns(from.sim_time_ns);
}

struct PutReply : PutModelReply {
  using PutModelReply::operator();

  void operator()(const Error& m) const {
    auto& w = *to.mutable_error();
    w.set_code(static_cast<v1::ErrorCode>(m.code));
    w.set_text(m.text);
    w.set_owner(m.owner);
  }
  void operator()(const Ok& m) const { to.mutable_ok()->set_acts_at_tick(m.acts_at_tick); }
  void operator()(const Welcome& m) const {
    auto& w = *to.mutable_welcome();
    w.set_version(m.version);
    w.set_server(m.server);
    w.set_session(m.session);
    w.set_role(static_cast<v1::Role>(m.role));
    w.set_tick_ns(m.tick_ns);
    w.set_scene(m.scene);
    w.set_clock(m.clock);
    w.set_simulated(m.simulated);
  }
  void operator()(const PartList& m) const {
    for (const PartSummary& part : m.parts) {
      auto& w = *to.mutable_parts()->add_parts();
      w.set_name(part.name);
      w.set_kind(part.kind);
      w.set_lease_owner(part.lease_owner);
    }
    to.mutable_parts();  // selects the oneof also if there is no part
  }
  void operator()(const LeaseGrant& m) const {
    to.mutable_lease()->set_part(m.part);
    to.mutable_lease()->set_epoch(m.epoch);
  }
  void operator()(const PartSample& m) const {
    auto& w = *to.mutable_part_sample();
    w.set_part(m.part);
    w.set_tick(m.tick);
    w.set_sim_time_ns(m.sim_time_ns);
    w.set_era(m.era);
    put_numbers(m.controller_inputs, w.mutable_controller_inputs());
    put_numbers(m.sensor_outputs, w.mutable_sensor_outputs());
    w.set_conflated(m.conflated);
  }
  void operator()(const BlackboardData& m) const {
    auto& w = *to.mutable_blackboard();
    w.set_offset(m.offset);
    w.set_total(m.total);
    w.set_data(bytes_of(m.data));
    w.set_generation(m.generation);
  }
  void operator()(const Advanced& m) const {
    auto& w = *to.mutable_advanced();
    w.set_tick(m.tick);
    w.set_sim_time_ns(m.sim_time_ns);
    w.set_era(m.era);
    w.set_bus_said(m.bus_said);
    put_streams(m.streams, w.mutable_streams());
  }
  void operator()(const SnapshotTaken& m) const {
    auto& w = *to.mutable_snapshot();
    w.set_snapshot(m.snapshot);
    w.set_tick(m.tick);
    w.set_state_hash(m.state_hash);
  }
  void operator()(const Event& m) const { put_event(m, *to.mutable_event()); }
  void operator()(const EventList& m) const {
    auto& w = *to.mutable_events();
    for (const auto& event : m.events) put_event(event, *w.add_events());
  }
  void operator()(const ServerStatus& m) const { wire::put(m, *to.mutable_status()); }
  void operator()(const PartDescriptionReply& m) const { wire::put(m, *to.mutable_part_description()); }
  void operator()(const ParameterList& m) const { wire::put(m, *to.mutable_parameters()); }
  void operator()(const WorldDescription& m) const { wire::put(m, *to.mutable_world_description()); }
  void operator()(const WorldSample& m) const { wire::put(m, *to.mutable_world_sample()); }
  void operator()(const TextureData& m) const {
    auto& w = *to.mutable_texture();
    w.set_content_type(m.content_type);
    w.set_data(bytes_of(m.data));
  }
  void operator()(const MeshData& m) const { wire::put(m, *to.mutable_mesh()); }
  void operator()(const FaultList& m) const { wire::put(m, *to.mutable_faults()); }
  void operator()(const ScenarioState& m) const { wire::put(m, *to.mutable_scenario()); }
  void operator()(const ModuleList& m) const { wire::put(m, *to.mutable_modules()); }
  void operator()(const OverrideModulePort& m) const { put_override(m, *to.mutable_override_module_port()); }
  void operator()(const SetModuleParameter& m) const { wire::put(m, *to.mutable_set_module_parameter()); }
};

bool take(const v1::Error& from, Error& to, std::string& why) {
  to.text = from.text();
  to.owner = from.owner();
  return take_enum(from.code(), ErrorCode::kInternal, to.code, "error code", why);
}

bool take(const v1::Welcome& from, Welcome& to, std::string& why) {
  to.version = from.version();
  to.server = from.server();
  to.session = from.session();
  to.tick_ns = from.tick_ns();
  to.scene = from.scene();
  to.clock = from.clock();
  to.simulated = from.simulated();
  return take_enum(from.role(), Role::kAdmin, to.role, "role", why);
}

void take(const v1::PartList& from, PartList& to) {
  for (const auto& w : from.parts()) to.parts.push_back({w.name(), w.kind(), w.lease_owner()});
}

void take(const v1::PartSample& from, PartSample& to) {
  to.part = from.part();
  to.tick = from.tick();
  to.sim_time_ns = from.sim_time_ns();
  to.era = from.era();
  take_numbers(from.controller_inputs(), to.controller_inputs);
  take_numbers(from.sensor_outputs(), to.sensor_outputs);
  to.conflated = from.conflated();
}

bool take(const v1::Event& from, Event& to, std::string& why) {
  to = {from.kind(), from.text(), from.part(), from.era(), from.tick()};
  to.source = from.source();
  to.sim_time_ns = from.sim_time_ns();
  return take_enum(from.level(), EventLevel::kError, to.level, "level", why);
}

bool take(const v1::EventList& from, EventList& to, std::string& why) {
  for (const auto& event : from.events())
    if (!take(event, to.events.emplace_back(), why)) return false;
  return true;
}

BlackboardData blackboard_of(const v1::BlackboardData& from) {
  return {from.offset(), from.total(), bytes_of(from.data()), from.generation()};
}

}  // namespace

std::string bytes_of(const std::vector<std::byte>& from) {
  return {reinterpret_cast<const char*>(from.data()), from.size()};
}

std::vector<std::byte> bytes_of(const std::string& from) {
  const auto* first = reinterpret_cast<const std::byte*>(from.data());
  return {first, first + from.size()};
}

void put(const Reply& from, v1::ServerMessage& to) {
  std::visit(PutReply{{to}}, from);
}

bool take(const v1::ServerMessage& from, Reply& to, std::string& why) {
  using Case = v1::ServerMessage;
  const auto& advanced = from.advanced();
  const auto& snapshot = from.snapshot();
  switch (from.body_case()) {
    case Case::BODY_NOT_SET:
      why = "no reply that this version knows";
      return false;
    case Case::kError:
      return take(from.error(), to.emplace<Error>(), why);
    case Case::kOk:
      to = Ok{from.ok().acts_at_tick()};
      return true;
    case Case::kWelcome:
      return take(from.welcome(), to.emplace<Welcome>(), why);
    case Case::kStatus:
      take(from.status(), to.emplace<ServerStatus>());
      return true;
    case Case::kParts:
      take(from.parts(), to.emplace<PartList>());
      return true;
    case Case::kPartDescription:
      return take(from.part_description(), to.emplace<PartDescriptionReply>(), why);
    case Case::kLease:
      to = LeaseGrant{from.lease().part(), from.lease().epoch()};
      return true;
    case Case::kPartSample:
      take(from.part_sample(), to.emplace<PartSample>());
      return true;
    case Case::kParameters:
      return take(from.parameters(), to.emplace<ParameterList>(), why);
    case Case::kBlackboard:
      to = blackboard_of(from.blackboard());
      return true;
    case Case::kAdvanced:
      to = Advanced{advanced.tick(), advanced.sim_time_ns(), advanced.era(), advanced.bus_said(),
                    streams_of(advanced.streams())};
      return true;
    case Case::kWorldDescription:
      take(from.world_description(), to.emplace<WorldDescription>());
      return true;
    case Case::kWorldSample:
      take(from.world_sample(), to.emplace<WorldSample>());
      return true;
    case Case::kTexture:
      to = TextureData{from.texture().content_type(), bytes_of(from.texture().data())};
      return true;
    case Case::kMesh:
      take(from.mesh(), to.emplace<MeshData>());
      return true;
    case Case::kSnapshot:
      to = SnapshotTaken{snapshot.snapshot(), snapshot.tick(), snapshot.state_hash()};
      return true;
    case Case::kModelSpawned:
    case Case::kModels:
    case Case::kScenes:
      take_model_reply(from, to);
      return true;
    case Case::kFaults:
      take(from.faults(), to.emplace<FaultList>());
      return true;
    case Case::kEvent:
      return take(from.event(), to.emplace<Event>(), why);
    case Case::kEvents:
      return take(from.events(), to.emplace<EventList>(), why);
    case Case::kScenario:
      return wire::take(from.scenario(), to.emplace<ScenarioState>(), why);
    case Case::kModules:
      return wire::take(from.modules(), to.emplace<ModuleList>(), why);
    case Case::kOverrideModulePort:
      to = override_of(from.override_module_port());
      return true;
    case Case::kSetModuleParameter:
      return wire::take(from.set_module_parameter(), to.emplace<SetModuleParameter>(), why);
  }
  why = "no reply that this version knows";
  return false;
}

}  // namespace visum::protocol::wire

// Translates between the plain messages (messages.h) and Protobuf's. Only codec.cc and the wire_*.cc files
// use it; they include Protobuf's headers, this file does not. Pure functions, any thread.
//
// put() fills an empty Protobuf message. take() fills a plain message. It returns false if the Protobuf
// message holds a value that no message of ours can have, and `why` names it: an empty oneof, or an
// enumerator that does not exist.
#pragma once

#include <string>
#include <vector>

#include "protocol/messages.h"

namespace visum::v1 {
class ClientMessage;
class ServerMessage;
class ParameterValue;
class PartDescription;
class ParameterList;
class ServerStatus;
class WorldDescription;
class WorldSample;
class MeshData;
class InjectFault;
class FaultList;
class ModuleList;
class ParameterDescription;
class BlackboardDescription;
class SetModuleParameter;
class ScenarioState;
}  // namespace visum::v1

namespace visum::protocol::wire {

void put(const Request& from, v1::ClientMessage& to);
bool take(const v1::ClientMessage& from, Request& to, std::string& why);
void put(const Reply& from, v1::ServerMessage& to);
bool take(const v1::ServerMessage& from, Reply& to, std::string& why);

// wire_part.cc
void put(const ParameterValue& from, v1::ParameterValue& to);
bool take(const v1::ParameterValue& from, ParameterValue& to, std::string& why);
void put(const Parameter& from, v1::ParameterDescription& to);
bool take(const v1::ParameterDescription& from, Parameter& to, std::string& why);
void put(const Blackboard& from, v1::BlackboardDescription& to);
Blackboard blackboard_of(const v1::BlackboardDescription& from);
void put(const PartDescriptionReply& from, v1::PartDescription& to);
bool take(const v1::PartDescription& from, PartDescriptionReply& to, std::string& why);
void put(const ParameterList& from, v1::ParameterList& to);
bool take(const v1::ParameterList& from, ParameterList& to, std::string& why);

// wire_world.cc
void put(const ServerStatus& from, v1::ServerStatus& to);
void take(const v1::ServerStatus& from, ServerStatus& to);
void put(const WorldDescription& from, v1::WorldDescription& to);
void take(const v1::WorldDescription& from, WorldDescription& to);
void put(const WorldSample& from, v1::WorldSample& to);
void take(const v1::WorldSample& from, WorldSample& to);
void put(const MeshData& from, v1::MeshData& to);
void take(const v1::MeshData& from, MeshData& to);

// wire_models.cc: models that come and go, and scenes.
struct PutModelRequest {
  v1::ClientMessage& to;
  void operator()(const SpawnModel& from) const;
  void operator()(const RemoveModel& from) const;
  void operator()(const ListModels& from) const;
  void operator()(const ListScenes& from) const;
  void operator()(const LoadScene& from) const;
};
// False if it is another request.
bool take_model_request(const v1::ClientMessage& from, Request& to);
struct PutModelReply {
  v1::ServerMessage& to;
  void operator()(const ModelSpawned& from) const;
  void operator()(const ModelList& from) const;
  void operator()(const SceneList& from) const;
};
void take_model_reply(const v1::ServerMessage& from, Reply& to);

// wire_modules.cc: the requests of module_messages.h, the list of modules, and locks of blackboards.
struct PutModuleRequest : PutModelRequest {
  using PutModelRequest::operator();

  void operator()(const AnnounceModules& from) const;
  void operator()(const ReportModules& from) const;
  void operator()(const ListModules& from) const;
  void operator()(const OverrideModulePort& from) const;
  void operator()(const SetModuleParameter& from) const;
  void operator()(const LockBlackboard& from) const;
  void operator()(const UnlockBlackboard& from) const;
};
// False, and `why` stays empty, if it is another request.
bool take_module_request(const v1::ClientMessage& from, Request& to, std::string& why);
void put(const ModuleList& from, v1::ModuleList& to);
bool take(const v1::ModuleList& from, ModuleList& to, std::string& why);

// wire_scenarios.cc
struct PutScenarioRequest : PutModuleRequest {
  using PutModuleRequest::operator();
  void operator()(const RunScenario& from) const;
  void operator()(const StopScenario& from) const;
  void operator()(const ReadScenario& from) const;
};
bool take_scenario_request(const v1::ClientMessage& from, Request& to);  // false: it is another request
void put(const ScenarioState& from, v1::ScenarioState& to);
bool take(const v1::ScenarioState& from, ScenarioState& to, std::string& why);

// SetModuleParameter and OverrideModulePort go both ways.
void put(const SetModuleParameter& from, v1::SetModuleParameter& to);
bool take(const v1::SetModuleParameter& from, SetModuleParameter& to, std::string& why);
template <typename Wire>
void put_override(const OverrideModulePort& from, Wire& to) {
  to.set_part(from.part);
  to.set_path(from.path);
  to.set_port(from.port);
  to.set_value(from.value);
  to.set_release(from.release);
}
template <typename Wire>
OverrideModulePort override_of(const Wire& from) {
  return {from.part(), from.path(), from.port(), from.value(), from.release()};
}

// For Advance and Advanced, which both carry a list of Stream.
template <typename Repeated>
void put_streams(const std::vector<Stream>& from, Repeated* to) {
  for (const Stream& stream : from) {
    auto& w = *to->Add();
    w.set_port(stream.port);
    w.set_written(stream.written);
    w.set_heard(stream.heard);
  }
}
template <typename Repeated>
std::vector<Stream> streams_of(const Repeated& from) {
  std::vector<Stream> to;
  for (const auto& w : from) to.push_back({w.port(), w.written(), w.heard()});
  return to;
}
// wire_fault.cc
void put(const InjectFault& from, v1::InjectFault& to);
void take(const v1::InjectFault& from, InjectFault& to);
void put(const FaultList& from, v1::FaultList& to);
void take(const v1::FaultList& from, FaultList& to);

// Takes an enumerator from the wire. The valid ones are 0 to `last`.
template <typename Enum>
bool take_enum(int from, Enum last, Enum& to, const char* name, std::string& why) {
  if (from < 0 || from > static_cast<int>(last)) {
    why = std::string(name) + " " + std::to_string(from) + " does not exist";
    return false;
  }
  to = static_cast<Enum>(from);
  return true;
}

// Copies numbers as one block, which RepeatedField stores side by side.
template <typename T, typename Field>
void put_numbers(const std::vector<T>& from, Field* to) {
  to->Add(from.begin(), from.end());
}
template <typename Field, typename T>
void take_numbers(const Field& from, std::vector<T>& to) {
  to.assign(from.data(), from.data() + from.size());
}

template <typename Repeated>
void put_texts(const std::vector<std::string>& from, Repeated* to) {
  to->Assign(from.begin(), from.end());
}
template <typename Repeated>
std::vector<std::string> texts_of(const Repeated& from) {
  return {from.begin(), from.end()};
}

// Protobuf keeps bytes in a std::string.
std::string bytes_of(const std::vector<std::byte>& from);
std::vector<std::byte> bytes_of(const std::string& from);

}  // namespace visum::protocol::wire

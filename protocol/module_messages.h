// The messages about modules, groups and edges of controllers in MCA2's manner, as messages.h has the others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/part_description.h"

namespace visum::protocol {

// ---------------------------------------- client to server

enum class ModuleVector : std::uint32_t {
  kUnspecified = 0,
  kControllerInput = 1,
  kControllerOutput = 2,
  kSensorInput = 3,
  kSensorOutput = 4,
};
const char* to_string(ModuleVector vector);  // "Controller Input", ...

struct ModuleDescription {
  std::string path;
  bool is_group = false;
  std::vector<std::string> controller_inputs{}, controller_outputs{}, sensor_inputs{}, sensor_outputs{};
  std::vector<Parameter> parameters{};
};
struct ModuleEnd {
  std::string part, path;
  ModuleVector vector = ModuleVector::kUnspecified;
  std::uint32_t first = 0;
};
struct ModuleEdge {
  ModuleEnd from, to;
  std::uint32_t count = 0;
};
struct AnnounceModules {
  std::string part;
  std::int64_t period_ns = 0;
  std::vector<ModuleDescription> modules{};
  std::vector<ModuleEdge> edges{};
  std::string address{};
  std::vector<Blackboard> blackboards{};
};
struct ModuleState {
  std::vector<double> controller_inputs{}, controller_outputs{}, sensor_inputs{}, sensor_outputs{};
  std::int64_t control_ns = 0, sense_ns = 0;
  std::vector<std::uint32_t> overridden{};
  std::vector<ParameterValue> parameters{};
};
struct ModuleBlackboard {
  std::uint64_t elements = 0, generation = 0;
  std::vector<std::byte> head{};
};
struct ReportModules {
  std::string part;
  std::int64_t time_ns = 0;
  std::vector<ModuleState> modules{};
  std::vector<ModuleBlackboard> blackboards{};
};
struct ListModules {
  std::string part{};
  std::uint64_t known_revision = 0;
};
struct OverrideModulePort {  // goes both ways
  std::string part, path, port;
  double value = 0.0;
  bool release = false;
};
struct SetModuleParameter {  // goes both ways
  std::string part, path, name;
  ParameterValue value;
};

// ---------------------------------------- server to client

struct ModulePart {
  std::string client;
  AnnounceModules announced;
  ReportModules reported;
};
struct ModuleList {
  std::uint64_t revision = 0;
  std::vector<ModulePart> parts{};
};

}  // namespace visum::protocol

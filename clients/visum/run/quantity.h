// The quantities that a scenario can measure: the world's truth and the parts' ports. The table in
// quantity.cc lists their kinds.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "clients/visum/run/scenario.h"
#include "protocol/messages.h"

namespace visum::run {

// The names and indices that are known before the first tick.
struct Catalogue {
  protocol::WorldDescription world;
  std::map<std::string, protocol::PartDescription> parts;
  std::map<std::string, std::vector<protocol::FaultKind>> faults;  // the kinds that each part knows
};

// One step's data. Peaks in `world` cover the time since the step before.
struct Observation {
  protocol::WorldSample world;
  std::map<std::string, protocol::PartSample> parts;  // only those that a check needs
};

// A quantity tied to the bodies, joints and ports that it names.
struct Quantity {
  std::string text;  // "distance of box to (0.5 -0.2 0.24)"
  std::string unit;
  const QuantitySpec* spec = nullptr;
  std::vector<std::size_t> indices;  // bodies, joints or a port, as its kind has it
  bool output = false;               // port: sensor output or controller input
  protocol::Port port;               // port: with the names of its values or bits
  Coverage coverage;                 // so far
  double (*measure)(Quantity& self, const Observation& now) = nullptr;
};

struct QuantityKind {
  const char* name;
  const char* help;
  std::vector<std::string_view> keys;                           // that its map may have
  void (*read)(const config::Node& node, QuantitySpec& spec);   // throws ConfigError
  void (*tie)(const Catalogue& catalogue, Quantity& quantity);  // throws ConfigError where a name is unknown
  double (*measure)(Quantity& self, const Observation& now);    // once per step: it may remember
};
std::span<const QuantityKind> quantity_kinds();

// A map with one key, the kind: {distance: {...}}. Throws ConfigError.
QuantitySpec read_quantity(const std::string& kind, const config::Node& node);
// `spec` must outlive the quantity.
Quantity tie(const QuantitySpec& spec, const Catalogue& catalogue);
// After bodies came or went; what was found so far stays.
void tie_again(Quantity& quantity, const Catalogue& catalogue);

}  // namespace visum::run

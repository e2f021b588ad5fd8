#include "clients/visum/run/lookup.h"
#include "protocol/config/unknown_name.h"

#include <algorithm>

namespace visum::run {
namespace {

template <typename T>
std::vector<std::string> names_of(const std::vector<T>& things) {
  std::vector<std::string> names;
  for (const T& thing : things) names.push_back(thing.name);
  return names;
}

template <typename T>
std::size_t find_named(const std::vector<T>& things, const char* what, const std::string& name,
                       const config::Place& place) {
  const auto found =
      std::find_if(things.begin(), things.end(), [&](const T& thing) { return thing.name == name; });
  if (found == things.end()) fail_unknown(place, what, name, names_of(things));
  return static_cast<std::size_t>(found - things.begin());
}

}  // namespace

void fail_unknown(const config::Place& place, const std::string& what, const std::string& name,
                  const std::vector<std::string>& known) {
  throw config::ConfigError(place, config::unknown_name(what, name, known));
}

std::size_t find_body(const Catalogue& catalogue, const std::string& name, const config::Place& place) {
  return find_named(catalogue.world.bodies, "body", name, place);
}

std::size_t find_joint(const Catalogue& catalogue, const std::string& name, const config::Place& place) {
  return find_named(catalogue.world.joints, "joint", name, place);
}

const protocol::PartDescription& find_part(const Catalogue& catalogue, const std::string& name,
                                           const config::Place& place) {
  const auto found = catalogue.parts.find(name);
  if (found != catalogue.parts.end()) return found->second;
  std::vector<std::string> known;
  for (const auto& [part, description] : catalogue.parts) known.push_back(part);
  fail_unknown(place, "part", name, known);
}

PortPlace find_port(const protocol::PartDescription& part, const std::string& name,
                    const config::Place& place) {
  for (std::size_t i = 0; i < part.sensor_outputs.size(); ++i) {
    if (part.sensor_outputs[i].name == name) return {i, true, &part.sensor_outputs[i]};
  }
  for (std::size_t i = 0; i < part.controller_inputs.size(); ++i) {
    if (part.controller_inputs[i].name == name) return {i, false, &part.controller_inputs[i]};
  }
  auto known = names_of(part.sensor_outputs);
  for (const auto& input : names_of(part.controller_inputs)) known.push_back(input);
  fail_unknown(place, "port of part '" + part.name + "' called", name, known);
}

const protocol::FaultKind& find_fault(const Catalogue& catalogue, const std::string& part,
                                      const std::string& kind, const config::Place& place) {
  find_part(catalogue, part, place);
  std::vector<std::string> known;
  for (const auto& row : catalogue.faults.at(part)) {
    if (row.name == kind) return row;
    known.push_back(row.name);
  }
  fail_unknown(place, "fault of part '" + part + "' called", kind, known);
}

}  // namespace visum::run

// Turns names of a scenario into indices of the world and its parts. An unknown name throws ConfigError at
// `place`; the message suggests the nearest name.
#pragma once

#include <string>
#include <vector>

#include "clients/visum/run/quantity.h"

namespace visum::run {

[[noreturn]] void fail_unknown(const config::Place& place, const std::string& what, const std::string& name,
                               const std::vector<std::string>& known);

std::size_t find_body(const Catalogue& catalogue, const std::string& name, const config::Place& place);
std::size_t find_joint(const Catalogue& catalogue, const std::string& name, const config::Place& place);
const protocol::PartDescription& find_part(const Catalogue& catalogue, const std::string& name,
                                           const config::Place& place);

struct PortPlace {
  std::size_t index = 0;
  bool output = false;
  const protocol::Port* port = nullptr;
};
PortPlace find_port(const protocol::PartDescription& part, const std::string& name,
                    const config::Place& place);

// The kind of fault of this name, if the part knows it.
const protocol::FaultKind& find_fault(const Catalogue& catalogue, const std::string& part,
                                      const std::string& kind, const config::Place& place);

}  // namespace visum::run

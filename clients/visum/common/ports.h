// Finds ports by the words that a user types: a port's name, or a group's name for all its ports.
#pragma once

#include <string>
#include <vector>

#include "protocol/part_description.h"

namespace visum::cli {

struct PortRef {
  bool output = false;                   // which vector: sensor outputs or controller inputs
  std::size_t index = 0;                 // in it
  const protocol::Port* port = nullptr;  // in the description
};

// Sensor outputs first, then controller inputs. No names: all of both. An unknown name throws
// ExitError(kUsage) with the nearest names.
std::vector<PortRef> find_ports(const protocol::PartDescription& part, const std::vector<std::string>& names);

// One controller input, by name. A sensor output of that name is refused as such.
PortRef find_input(const protocol::PartDescription& part, const std::string& name);

// Reads a number that the port takes. Throws ExitError(kUsage), which names port and range.
double read_value(const protocol::PartDescription& part, const protocol::Port& port, const std::string& text);

}  // namespace visum::cli

// Look-ups by name for agents' PartLinks, shared by the daemon's and the client's. Pure functions, any
// thread.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/config/config.h"
#include "protocol/config/number_text.h"
#include "protocol/config/unknown_name.h"
#include "protocol/plugin/plugin.h"

namespace visum::plugin {

// Index of the entry with this name. Throws Error: "part 'cart': there is no output 'Sped 1'; did you mean
// 'Speed 1'?"
template <typename Named>
std::size_t index_of(const std::vector<Named>& list, std::string_view name, const std::string& part,
                     const char* what) {
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const Named& entry) { return entry.name == name; });
  if (found != list.end()) return static_cast<std::size_t>(found - list.begin());
  std::vector<std::string> names;
  for (const auto& entry : list) names.push_back(entry.name);
  throw Error("part '" + part + "': " + config::unknown_name(what, name, names));
}

// The port with this index. Throws Error if there is none.
template <typename Port>
const Port& port_at(const std::vector<Port>& ports, std::size_t index, const std::string& part,
                    const char* what) {
  if (index < ports.size()) return ports[index];
  throw Error("part '" + part + "' has no " + what + " number " + std::to_string(index) + ", it has " +
              std::to_string(ports.size()));
}

// Throws Error if the port cannot take this value.
template <typename Port>
void check_value(const Port& port, double value, const std::string& part) {
  if (value >= port.minimum && value <= port.maximum) return;  // false for NaN
  throw Error("part '" + part + "': '" + port.name + "' must be a number from " +
              config::number_text(port.minimum) + " to " + config::number_text(port.maximum) + ", is " +
              config::number_text(value));
}

template <typename From>
Port plain_port(const From& port) {
  return {port.name, port.unit, port.minimum, port.maximum, port.initial, port.group};
}

}  // namespace visum::plugin

#include "clients/visum/common/ports.h"

#include <charconv>
#include <cmath>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/common/format.h"
#include "clients/visum/common/link.h"
#include "protocol/config/unknown_name.h"

namespace visum::cli {
namespace {

using protocol::PartDescription;
using protocol::Port;

void collect(std::vector<PortRef>& found, const std::vector<Port>& ports, bool output, auto&& wanted) {
  for (std::size_t i = 0; i < ports.size(); ++i) {
    if (wanted(ports[i])) found.push_back({output, i, &ports[i]});
  }
}

std::vector<PortRef> collect_both(const PartDescription& part, auto&& wanted) {
  std::vector<PortRef> found;
  collect(found, part.sensor_outputs, true, wanted);
  collect(found, part.controller_inputs, false, wanted);
  return found;
}

std::vector<std::string> names_of(const std::vector<PortRef>& ports) {
  std::vector<std::string> names;
  for (const PortRef& ref : ports) names.push_back(ref.port->name);
  return names;
}

}  // namespace

std::vector<PortRef> find_ports(const PartDescription& part, const std::vector<std::string>& names) {
  const auto all = collect_both(part, [](const Port&) { return true; });
  if (names.empty()) return all;
  std::vector<PortRef> found;
  for (const std::string& name : names) {
    auto matches = collect_both(part, [&](const Port& port) { return port.name == name; });
    if (matches.empty()) matches = collect_both(part, [&](const Port& port) { return port.group == name; });
    if (matches.empty()) {
      throw ExitError(kUsage, "part '" + part.name + "' has no port '" + name + "'" +
                                  config::did_you_mean(name, names_of(all)));
    }
    found.insert(found.end(), matches.begin(), matches.end());
  }
  return found;
}

PortRef find_input(const PartDescription& part, const std::string& name) {
  std::vector<std::string> inputs;
  for (std::size_t i = 0; i < part.controller_inputs.size(); ++i) {
    const Port& port = part.controller_inputs[i];
    if (port.name == name) return {false, i, &port};
    inputs.push_back(port.name);
  }
  for (const Port& port : part.sensor_outputs) {
    if (port.name == name) {
      throw ExitError(kUsage,
                      "'" + name + "' is a sensor output of part '" + part.name + "'; it can only be read");
    }
  }
  throw ExitError(kUsage, "part '" + part.name + "' has no controller input '" + name + "'" +
                              config::did_you_mean(name, inputs));
}

double read_value(const PartDescription& part, const Port& port, const std::string& text) {
  const std::string unit = port.unit.empty() ? "" : " " + port.unit;
  double value = 0.0;
  const char* end = text.data() + text.size();
  const char* begin = text.starts_with('+') ? text.data() + 1 : text.data();
  const auto result = std::from_chars(begin, end, value);
  if (result.ec == std::errc() && result.ptr == end && std::isfinite(value) && value >= port.minimum &&
      value <= port.maximum) {
    return value;
  }
  throw ExitError(kUsage, "port '" + port.name + "' of part '" + part.name + "' takes " +
                              exact(port.minimum) + " .. " + exact(port.maximum) + unit + ", not '" + text +
                              "'");
}

}  // namespace visum::cli

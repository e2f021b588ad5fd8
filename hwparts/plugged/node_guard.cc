#include "hwparts/plugged/node_guard.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "protocol/plugin/node_settings.h"

namespace visum::plugged {

void NodeGuard::fail(std::string text) {
  fault_ = text.empty() ? "failed without saying why" : std::move(text);
  if (fault_.size() > kMaxFaultBytes) fault_.resize(kMaxFaultBytes);
}

void NodeGuard::fail_by_exception() {
  fail(plugin::text_of_current_exception());
}

void NodeGuard::reset(plugin::Node& node) {
  fault_.clear();
  run([&] { node.reset(); });
}

// Writes the fault, then the node's own block, which is empty where there is a fault.
void NodeGuard::save(const plugin::Node& node, hwparts::StateWriter& to) const {
  std::string fault = fault_;
  scratch_.clear();
  if (fault.empty()) {
    const plugin::ForeignCall standing(node_.c_str());
    try {
      plugin::StateOut out(scratch_);
      node.save(out);
      if (scratch_.size() > kMaxNodeBytes) throw plugin::Error("saves more than 16 MiB");
    } catch (...) {
      fault = "save: " + plugin::text_of_current_exception();
      scratch_.clear();
    }
  }
  to.put(static_cast<std::uint64_t>(fault.size()));
  to.put(std::as_bytes(std::span(fault)));
  to.put(static_cast<std::uint64_t>(scratch_.size()));
  to.put(std::span<const std::byte>(scratch_));
}

void NodeGuard::load(plugin::Node& node, hwparts::StateReader& from) {
  std::uint64_t size = 0;
  from.get(size);
  from.expect(size);
  fault_.assign(size, ' ');
  from.get(std::as_writable_bytes(std::span(fault_)));
  from.get(size);
  from.expect(size);
  scratch_.assign(size, std::byte{0});
  from.get(std::span(scratch_));
  run([&] {
    plugin::StateIn in(scratch_);
    node.load(in);
    if (!in.at_end()) throw plugin::Error("load: has read less than it saved");
  });
}

std::size_t add_port(std::vector<protocol::Port>& ports, const plugin::Port& port) {
  if (ports.size() == kMaxPorts) throw plugin::Error("has more than " + std::to_string(kMaxPorts) + " ports");
  if (port.name.empty()) throw plugin::Error("has a port without a name");
  if (std::ranges::any_of(ports, [&](const auto& other) { return other.name == port.name; }))
    throw plugin::Error("has two ports '" + port.name + "'");
  const bool finite =
      std::isfinite(port.minimum) && std::isfinite(port.maximum) && std::isfinite(port.initial);
  if (!finite || port.initial < port.minimum || port.initial > port.maximum)
    throw plugin::Error("port '" + port.name + "': its initial value must lie within its range");
  ports.push_back({port.name, port.unit, port.minimum, port.maximum, port.initial, port.group});
  return ports.size() - 1;
}

void check_values(std::span<const protocol::Port> ports, std::span<const double> values) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) throw plugin::Error("'" + ports[i].name + "' must be a finite number");
    if (values[i] < ports[i].minimum || values[i] > ports[i].maximum)
      throw plugin::Error("'" + ports[i].name + "' must be within " + std::to_string(ports[i].minimum) +
                          " and " + std::to_string(ports[i].maximum) + ", is " + std::to_string(values[i]));
  }
}

protocol::Port state_port() {
  return {"Node State", "", 0.0, 1.0, 0.0, ""};
}

protocol::Blackboard fault_blackboard() {
  return {"fault", "text/plain", 1, 0, kMaxFaultBytes, false};
}

}  // namespace visum::plugged

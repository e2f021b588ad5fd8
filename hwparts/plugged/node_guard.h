// The guard around every node of a plug-in: it turns exceptions into the node's fault, checks its ports, and
// saves its state as a block of bytes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "hwparts/state_archive.h"
#include "protocol/part_description.h"
#include "protocol/plugin/foreign_call.h"
#include "protocol/plugin/plugin.h"

namespace visum::plugged {

// Knows whether a node works, and if not, why. A node that has failed is not called again until reset() or
// load(). The part, sensor or agent around the node owns it; it lives on the tick's thread.
class NodeGuard {
 public:
  explicit NodeGuard(std::string node) : node_(std::move(node)) {}  // "agent 'explorer'"

  bool works() const { return fault_.empty(); }
  const std::string& fault() const { return fault_; }
  void fail(std::string text);
  void forgive() { fault_.clear(); }
  // Runs `call`, unless the node has failed before. True: it came to its end without an exception.
  template <typename Call>
  bool run(const Call& call) {
    if (!works()) return false;
    const plugin::ForeignCall standing(node_.c_str());
    try {
      call();
    } catch (...) {
      fail_by_exception();
    }
    return works();
  }

  void reset(plugin::Node& node);
  void save(const plugin::Node& node, hwparts::StateWriter& to) const;
  void load(plugin::Node& node, hwparts::StateReader& from);

  std::span<const std::byte> blackboard() const { return std::as_bytes(std::span(fault_)); }

 private:
  void fail_by_exception();

  const std::string node_;
  std::string fault_;
  mutable std::vector<std::byte> scratch_;
};

// Checks and appends a port, and returns its index. Throws plugin::Error for a bad one.
std::size_t add_port(std::vector<protocol::Port>& ports, const plugin::Port& port);
// Throws plugin::Error at the first value that is not finite or lies outside of its port's range.
void check_values(std::span<const protocol::Port> ports, std::span<const double> values);
// The last output of every node (0: it works, 1: it is in fault), and the blackboard with the reason.
protocol::Port state_port();
protocol::Blackboard fault_blackboard();

inline constexpr std::size_t kMaxPorts = 4096;
inline constexpr std::size_t kMaxFaultBytes = 1024;
inline constexpr std::size_t kMaxNodeBytes = 16u << 20;

}  // namespace visum::plugged

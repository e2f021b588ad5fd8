// One of the two arms behind a mirror: a session with the server of a part, its lease, its newest sample.
// When the server goes it is looked for again, once a second. One thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/client.h"

namespace visum::gateway {

class ArmLink {
 public:
  // Connects, takes the part's lease and a first sample. `token`: where the server wants one. Throws
  // std::runtime_error that names the address.
  ArmLink(std::string address, std::string part, std::string token);

  const std::string& address() const { return address_; }
  const protocol::PartDescription& description() const { return description_; }
  bool simulated() const { return simulated_; }
  std::int64_t tick_ns() const { return tick_ns_; }

  bool connected() const { return connection_.has_value(); }
  int descriptor() const { return connected() ? connection_->native_handle() : -1; }
  // As of the newest sample.
  std::span<const double> sensor_outputs() const { return sample_.sensor_outputs; }

  // Takes in what came, without waiting, and looks for a server that is gone. True once after it was found
  // again.
  bool poll();
  // All controller inputs in the mirror's count. Counters act on changes, and each arm has counted its own
  // way so far: `initial` are the mirror's own beginnings, from which the arm's are continued.
  void write(std::span<const double> inputs, std::span<const double> initial);
  void rebase(std::span<const double> inputs, std::span<const double> initial);
  // Leaves as a controller that is lost does: the arm stops as it would then. Comes back at the next poll().
  void drop();

  std::vector<protocol::Parameter> parameters();
  std::optional<std::string> set_parameter(const std::string& name, const protocol::ParameterValue& value);
  std::vector<std::byte> read_blackboard(const std::string& name);

 private:
  using Clock = std::chrono::steady_clock;
  void connect();
  void lose(const std::string& why);
  bool look_again();

  std::string address_, part_, token_;
  std::optional<protocol::Connection> connection_;
  protocol::PartDescription description_;
  bool simulated_ = true;
  std::int64_t tick_ns_ = 0;
  protocol::PartSample sample_;
  std::vector<double> ahead_;  // of the arm's counters, to the mirror's; 0 for other ports
  Clock::time_point tried_{};
};

// A counter among the controller inputs: acts when its number changes.
bool is_counter(const protocol::Port& port);

}  // namespace visum::gateway

// One of the two arms behind a mirror: a session with the server of a part, its lease, its newest sample.
// When the server goes it is looked for again, once a second, on a thread of its own: nobody waits for it.
// All calls come from one thread.
#pragma once

#include <chrono>
#include <cstdint>
#include <future>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/client.h"
#include "server/mirror/entry.h"

namespace visum::mirror {

// A counter among the controller inputs: acts when its number changes.
bool is_counter(const protocol::Port& port);
// In what two parts are not alike: their kind, or the names and units of their ports.
std::optional<std::string> difference(const protocol::PartDescription& a, const protocol::PartDescription& b);

class ArmLink {
 public:
  // Connects, takes the part's lease and a first sample. Throws
  // std::runtime_error that names the address.
  ArmLink(std::string address, std::string part, Entry entry);

  const std::string& address() const { return address_; }
  const protocol::PartDescription& description() const { return description_; }
  bool simulated() const { return simulated_; }
  std::int64_t tick_ns() const { return tick_ns_; }

  bool connected() const { return connection_.has_value(); }
  int descriptor() const { return connected() ? connection_->native_handle() : -1; }
  // As of the newest sample.
  std::span<const double> sensor_outputs() const { return sample_.sensor_outputs; }

  // Takes in what came, without waiting, and looks for a server that is gone, or hangs. True where the arm's
  // counters are not as the mirror left them: it was found again, or its server has put its inputs back
  // (Reset, RestoreSnapshot). rebase() is to be called then, before anything is written.
  bool poll();
  // Left a moment ago because its controller was lost, and being looked for: most likely it is back soon.
  bool comes_back() const;
  // How many writes the arm has refused, and why the last one.
  std::uint64_t refusals() const { return refusals_; }
  const std::string& refusal() const { return refusal_; }

  // All controller inputs in the mirror's count. Counters act on changes, and each arm has counted its own
  // way so far: `initial` are the mirror's own beginnings, from which the arm's are continued. Counters are
  // sent only where one of them is due: a write that crosses a Reset of the arm's world changes none. Where
  // the mirror's count would lead out of the arm's range, the arm's begins anew from below.
  void write(std::span<const double> inputs, std::span<const double> initial);
  void rebase(std::span<const double> inputs, std::span<const double> initial);
  // The same with only the counters of `inputs`, each by itself: all other inputs stay as the arm has them,
  // and none that it refuses keeps another from it.
  void write_counters(std::span<const double> inputs, std::span<const double> initial);
  // Leaves as a controller that is lost does: the arm stops as it would then. Comes back at the next poll().
  void drop();

  bool has_parameter(const std::string& name) const;
  std::vector<protocol::Parameter> parameters();
  std::optional<protocol::ParameterValue> parameter(const std::string& name);
  // Returns why not. In two halves, so that both arms can be asked before either one answers.
  std::optional<std::string> set_parameter(const std::string& name, const protocol::ParameterValue& value);
  void ask_to_set(const std::string& name, const protocol::ParameterValue& value);
  std::optional<std::string> answer();
  std::vector<std::byte> read_blackboard(const std::string& name);

 private:
  using Clock = std::chrono::steady_clock;
  struct Found {
    protocol::Connection connection;
    protocol::PartDescription description;
    protocol::PartSample sample;
  };
  // `before`: what the part has to be like; an empty name: like anything. Throws OtherPart where it is not.
  static Found find(const std::string& address, const std::string& part, const Entry& entry,
                    const protocol::PartDescription& before);
  void adopt(Found found);
  void lose(const std::string& why);
  void lose_unless_refused(const std::exception& error);
  void check_answers();
  bool look_again();
  std::vector<double> as_the_arm_counts(std::span<const double> inputs, std::span<const double> initial);
  bool is_counter_at(std::size_t port) const { return is_counter(description_.controller_inputs[port]); }
  bool same_counters(std::span<const double> a, std::span<const double> b) const;
  void take(protocol::PartSample sample);
  void send_runs(std::span<const double> values, bool of_counters);
  void send(std::size_t first, std::span<const double> values);

  std::string address_, part_;
  Entry entry_;
  std::optional<protocol::Connection> connection_;
  protocol::PartDescription description_;
  bool simulated_ = true;
  std::int64_t tick_ns_ = 0;
  protocol::PartSample sample_;
  std::uint64_t refusals_ = 0;
  std::string refusal_;
  std::vector<double> ahead_;               // of the arm's counters, to the mirror's; 0 for other ports
  std::vector<double> sent_;                // as last sent, or found by rebase(); NaN: to be sent in any case
  std::optional<std::int64_t> counted_at_;  // the newest tick when a counter was sent; none since rebase()
  bool put_back_ = false;                   // the arm's counters are not as they were sent: rebase() is due
  std::optional<std::uint64_t> asked_;      // to set a parameter
  Clock::time_point tried_{}, left_at_{};
  Clock::time_point heard_at_{}, probed_at_{};  // of this connection
  std::optional<std::uint64_t> probe_;          // a request that only asks whether the server answers
  std::future<void> closing_;                   // what was left: that waits for the server
  std::future<Found> search_;
  bool told_other_part_ = false;
};

}  // namespace visum::mirror

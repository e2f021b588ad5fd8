// One of the two arms behind a mirror: a session with the server of a part, its lease, its newest sample.
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

// True for counters among the controller inputs: these act when their number changes.
bool is_counter(const protocol::Port& port);
// The first difference between two parts, in their kind or in the names and units of their ports.
std::optional<std::string> difference(const protocol::PartDescription& a, const protocol::PartDescription& b);

// Owned by the Mirror. All calls come from one thread. When the server goes away, it is looked for again once
// a second, on a thread of its own, so that no call waits for it.
class ArmLink {
 public:
  // Connects, takes the part's lease and a first sample. Throws std::runtime_error that names the address.
  ArmLink(std::string address, std::string part, Entry entry);

  const std::string& address() const { return address_; }
  const protocol::PartDescription& description() const { return description_; }
  bool simulated() const { return simulated_; }
  std::int64_t tick_ns() const { return tick_ns_; }

  bool connected() const { return connection_.has_value(); }
  int descriptor() const { return connected() ? connection_->native_handle() : -1; }
  // From the newest sample.
  std::span<const double> sensor_outputs() const { return sample_.sensor_outputs; }

  // Takes in what came, without waiting. Notices a server that hangs, and looks for one that is gone. True:
  // the arm's counters are not as the mirror left them, because it was found again, or because its server has
  // put its inputs back (Reset, RestoreSnapshot). Then rebase() has to be called before anything is written.
  bool poll();
  // True: we left it a moment ago because its controller was lost, and look for it. It is most likely back
  // soon.
  bool comes_back() const;
  // How many writes the arm has refused, and why it refused the last one.
  std::uint64_t refusals() const { return refusals_; }
  const std::string& refusal() const { return refusal_; }

  // Writes all controller inputs, with counters in the mirror's count. Counters act on changes, and each arm
  // has counted in its own way so far. `initial` holds the mirror's counts at its start; the arm's counts are
  // continued from there. Counters are sent only when one of them is due, so that a write that crosses a
  // Reset of the arm's world changes none. Where the mirror's count would leave the arm's range, the arm's
  // count begins anew from below.
  void write(std::span<const double> inputs, std::span<const double> initial);
  // Joins the mirror's counts to those that are in force in the arm now.
  void rebase(std::span<const double> inputs, std::span<const double> initial);
  // Writes only the counters of `inputs`, each by itself. All other inputs stay as the arm has them, and a
  // counter that the arm refuses does not stop the others.
  void write_counters(std::span<const double> inputs, std::span<const double> initial);
  // Leaves as a lost controller does, so that the arm stops. Comes back at the next poll().
  void drop();

  bool has_parameter(const std::string& name) const;
  std::vector<protocol::Parameter> parameters();
  std::optional<protocol::ParameterValue> parameter(const std::string& name);
  // Returns the reason where it failed. The second and third function are its two halves, so that both arms
  // can be asked before either one answers.
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
  // `before` is what the part has to be like; an empty name: any part will do. Throws OtherPart where the
  // part is another one.
  static Found find(const std::string& address, const std::string& part, const Entry& entry,
                    const protocol::PartDescription& before);
  void adopt(Found found);
  // The server is gone: logs it, and looks for it from now on.
  void lose(const std::string& why);
  // Likewise, unless the error is only a refusal.
  void lose_unless_refused(const std::exception& error);
  // Finds out whether a silent server still answers.
  void check_answers();
  // One step of the search for the server. True: it was found.
  bool look_again();
  // The inputs with the mirror's counts turned into the arm's.
  std::vector<double> as_the_arm_counts(std::span<const double> inputs, std::span<const double> initial);
  bool is_counter_at(std::size_t port) const { return is_counter(description_.controller_inputs[port]); }
  bool same_counters(std::span<const double> a, std::span<const double> b) const;
  void take(protocol::PartSample sample);
  // Sends what has changed: counters one by one, or runs of neighbours that are no counters.
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
  std::vector<double> ahead_;  // the arm's count that stands for the mirror's first; 0 for other ports
  std::vector<double> sent_;   // as last sent, or found by rebase(); NaN: to be sent in any case
  std::optional<std::int64_t>
      counted_at_;                      // the newest tick when a counter was sent; none: not since rebase()
  bool put_back_ = false;               // the arm's counters are not as they were sent: rebase() is due
  std::optional<std::uint64_t> asked_;  // the request of ask_to_set()
  Clock::time_point tried_{}, left_at_{};
  Clock::time_point heard_at_{}, probed_at_{};  // of this connection
  std::optional<std::uint64_t> probe_;          // a request that only asks whether the server answers
  std::future<void> closing_;  // closes the connection that we left, which waits for the server
  std::future<Found> search_;
  bool told_other_part_ = false;
};

}  // namespace visum::mirror

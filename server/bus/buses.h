// The buses of a world's parts. Requests that came over any of them reach the part's modules between ticks,
// and are answered at once from what the modules know since the last tick.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/messages.h"
#include "server/bus/address.h"
#include "server/bus/bus_thread.h"
#include "server/bus/cycle_gate.h"
#include "server/bus/line_timing.h"
#include "server/cycle/simulation.h"

namespace visum::bus {

// Lives on the tick's thread, and is owned by the daemon. It has a thread of its own that reads and writes
// (bus_thread.h).
class Buses {
 public:
  using Clock = std::chrono::steady_clock;

  // Opens all links. `wake`, called on the bus thread, makes the loop call serve() soon where it does not
  // wait in serve_until(). Throws std::runtime_error naming what cannot be opened.
  Buses(cycle::Simulation& simulation, const std::vector<BusAddress>& addresses, std::function<void()> wake);
  ~Buses();

  const BusNames& names() const { return names_; }
  const std::vector<protocol::PartBus>& addresses() const { return addresses_; }  // for Status
  std::vector<protocol::Exchange> exchanges() const;                              // the same; any thread

  std::uint64_t dropped() const { return thread_->dropped(); }  // any thread

  // All that follows: between ticks.

  // Handles what has come, at most kQueue requests. True: there was something.
  bool serve();
  // Handles what comes until then.
  void serve_until(Clock::time_point due);
  // Sends what modules say unasked, and what the lines have held back until now.
  void after_tick();
  // For a world that waits for its clients: handles and answers all that they have written by now. Where the
  // bytes that `streams` promise do not come, it logs a warning and goes on.
  bool settle(const std::vector<protocol::Stream>& streams);  // true if there was something
  std::uint64_t said() { return thread_->said(); }
  void fill_in(std::vector<protocol::Stream>& streams) { thread_->fill_in(streams); }

  // Requests to this part let the world run, by this rule, from now on. At most one gate for each part.
  void open_gate(std::uint32_t part, CycleRule rule);
  // Requests that still wait are handled and answered.
  void close_gate(std::uint32_t part);
  // The tick up to which the part's gate lets the world run.
  std::int64_t granted_tick(std::uint32_t part) const;

 private:
  // A telegram on a line that is not ideal, or an answer that a module gives late. Each direction keeps its
  // order.
  struct Waiting {
    std::int64_t ready_ns;                // when it may be sent
    std::optional<std::int64_t> through;  // when it has passed the line; none: it waits for its turn
    BusItem item;
  };
  struct LinkQueues {
    LineTiming timing;
    std::deque<Waiting> requests, answers;
    bool busy() const { return !requests.empty() || !answers.empty(); }
  };
  // Takes a request that no gate holds: handles it at once, or puts it on the line that it has to pass.
  void accept(const BusItem& item);
  // Wakes serve_until() and the loop. Any thread.
  void ring();
  // Gives a request to the modules, and their answer back.
  void handle(const BusItem& item);
  // Sends an answer, unless a gate holds it until the world has run its period.
  void answer(const BusItem& item, std::int64_t late_ns);
  void send(const BusItem& item, std::int64_t late_ns);
  void serve_gates();
  bool line_is_busy(std::uint32_t part) const;
  // After a reset or restore: empties the lines, and gates begin anew.
  void follow_era();
  // Handles requests that have passed their line, and writes answers that have passed theirs.
  void move_lines();
  struct Through {
    LineTiming::Way way;
    BusItem item;
  };
  // The next telegram that has passed the line by now.
  std::optional<Through> next_through(LinkQueues& line) const;
  // Sends the messages that modules send unasked.
  void send_spontaneous();
  // Has the bus thread's queue written, if there is an answer in it.
  void send();

  cycle::Simulation& simulation_;
  std::function<void()> wake_;
  BusNames names_;
  std::vector<protocol::PartBus> addresses_;
  std::vector<std::uint32_t> parts_;            // by link
  std::deque<std::atomic<std::uint64_t>> got_;  // by link: telegrams that came
  std::vector<LinkQueues> lines_;               // by link
  std::map<std::uint32_t, CycleGate> gates_;    // by part
  std::uint64_t era_ = 0;
  bool answered_ = false;  // an answer waits for send()
  bool settles_ = false;   // settle() is used: answers are written before send() returns
  int request_fd_;
  std::unique_ptr<BusThread> thread_;
};

}  // namespace visum::bus

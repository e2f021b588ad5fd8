// The buses of a world's parts: requests that came over any of them reach the part's modules between ticks,
// on the tick's thread, and are answered at once from what the modules know as of the last tick.
#pragma once

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

class Buses {
 public:
  using Clock = std::chrono::steady_clock;

  // Opens all links. `wake`, called on the bus thread, makes the loop call serve() soon where it does not
  // wait in serve_until(). Throws std::runtime_error naming what cannot be opened.
  Buses(cycle::Simulation& simulation, const std::vector<BusAddress>& addresses, std::function<void()> wake);
  ~Buses();

  const BusNames& names() const { return names_; }
  const std::vector<protocol::PartBus>& addresses() const { return addresses_; }  // for Status

  // The tick's thread, between ticks.
  bool serve();  // what is there, kQueue requests at most; true if there was something
  void serve_until(Clock::time_point due);  // what comes until then
  void after_tick();                        // sends what modules say unasked, and what the line held back
  // For a world that waits for its clients: obeys and answers all that they have written, before they are
  // heard of again. A warning, and on, where what `streams` promise has not come.
  bool settle(const std::vector<protocol::Stream>& streams);  // true if there was something
  std::uint64_t said() { return thread_->said(); }
  void fill_in(std::vector<protocol::Stream>& streams) { thread_->fill_in(streams); }

  // Requests to this part let the world run, by this rule, from now on. At most one gate for each part.
  void open_gate(std::uint32_t part, CycleRule rule);
  // What still waits is obeyed and answered.
  void close_gate(std::uint32_t part);
  // The tick up to which the part's gate lets the world run.
  std::int64_t granted_tick(std::uint32_t part) const;

 private:
  // What a line that is not ideal carries, or an answer that comes late. Each way in its order.
  struct Waiting {
    std::int64_t ready_ns;                // to be sent
    std::optional<std::int64_t> through;  // when it has gone over the line; none: it waits for its turn
    BusItem item;
  };
  struct LinkQueues {
    LineTiming timing;
    std::deque<Waiting> requests, answers;
    bool busy() const { return !requests.empty() || !answers.empty(); }
  };
  void accept(const BusItem& item);
  void ring();
  void handle(const BusItem& item);
  void answer(const BusItem& item, std::int64_t late_ns);
  void send(const BusItem& item, std::int64_t late_ns);
  void serve_gates();
  bool line_is_busy(std::uint32_t part) const;
  void follow_era();
  void move_lines();
  struct Through {
    LineTiming::Way way;
    BusItem item;
  };
  std::optional<Through> next_through(LinkQueues& line) const;
  void send_spontaneous();
  void send();

  cycle::Simulation& simulation_;
  std::function<void()> wake_;
  BusNames names_;
  std::vector<protocol::PartBus> addresses_;
  std::vector<std::uint32_t> parts_;          // by link
  std::vector<LinkQueues> lines_;             // by link
  std::map<std::uint32_t, CycleGate> gates_;  // by part
  std::uint64_t era_ = 0;
  bool answered_ = false;  // something waits for send()
  bool settles_ = false;   // then answers leave before we go on
  int request_fd_;
  std::unique_ptr<BusThread> thread_;
};

}  // namespace visum::bus

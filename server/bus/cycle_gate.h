// Grade L1 of the lockstep, for programs that know nothing of a simulated clock. Such a program asks and is
// answered in cycles, and each cycle lets the world run by one period. A rule says which request ends a
// cycle. Requests that come while the world runs its period wait, so the program's speed makes no difference.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/bus/bus_item.h"

namespace visum::bus {

// The rule that says which request ends a cycle.
struct CycleRule {
  std::int64_t period_ticks = 1;
  // A frame to this module that begins with these bytes ends a cycle: it is handled at once, and its answer
  // leaves when the period is over. Empty: a request that was made already in this cycle ends it; then the
  // period comes first, and the request is handled and answered after it.
  std::uint8_t module = 0;
  std::vector<std::uint8_t> frame;
};

// The gate of one part's buses. Lives on the tick's thread, between ticks; Buses owns it.
class CycleGate {
 public:
  struct Answer {
    BusItem item;
    std::int64_t late_ns = 0;
  };
  CycleGate(CycleRule rule, std::int64_t tick) : rule_(std::move(rule)), granted_tick_(tick) {}

  // A request has come. More than kQueue that wait are lost, as in a receiver that overruns.
  void ask(const BusItem& request);
  // The next request that is to be handled at `tick`; none: no request waits, or the world runs first.
  std::optional<BusItem> next(std::int64_t tick);
  // The tick up to which the world may run.
  std::int64_t granted_tick() const { return granted_tick_; }

  // Keeps an answer until the world has run its period.
  void hold(const Answer& answer) { answers_.push_back(answer); }
  // The answers that may leave at `tick`.
  std::vector<Answer> released(std::int64_t tick);

  // The world stands at `tick` and will not move again, whatever was granted.
  void restart(std::int64_t tick) { granted_tick_ = tick; }
  // After a reset or restore: a cycle begins with the requests that wait, and answers that wait leave.
  void begin_era(std::int64_t tick) {
    restart(tick);
    asked_.clear();
    paid_ = false;
  }
  // The requests that still wait when the gate is closed.
  std::deque<BusItem>& requests() { return requests_; }

 private:
  static constexpr std::size_t kQueue = 1024;
  using Key = std::pair<std::uint8_t, std::vector<std::uint8_t>>;  // module; command and parameter

  static Key key_of(const powercube::Telegram& telegram);
  bool is_named(const powercube::Telegram& telegram) const;

  CycleRule rule_;
  std::int64_t granted_tick_;
  std::deque<BusItem> requests_;
  std::vector<Answer> answers_;
  std::set<Key> asked_;  // in this cycle
  bool paid_ = false;    // the period that the first waiting request asked for is over
};

}  // namespace visum::bus

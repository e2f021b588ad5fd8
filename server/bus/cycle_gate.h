// Grade L1: a program that asks and is answered, and knows nothing of a clock, lets the world run by a period
// for each of its cycles. Which request ends a cycle is a rule; while the world runs its period, what comes
// waits, so that how fast the program is makes no difference. Lives on the tick's thread, between ticks.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/bus/bus_item.h"

namespace visum::bus {

struct CycleRule {
  std::int64_t period_ticks = 1;
  // The frame to this module that begins with these bytes ends a cycle: it is obeyed, and its answer leaves
  // when the period is over. Empty: a request that was made already in this cycle ends it: the period comes
  // first, then it is obeyed and answered.
  std::uint8_t module = 0;
  std::vector<std::uint8_t> frame;
};

class CycleGate {
 public:
  struct Answer {
    BusItem item;
    std::int64_t late_ns = 0;
  };
  CycleGate(CycleRule rule, std::int64_t tick) : rule_(std::move(rule)), granted_tick_(tick) {}

  // A request has come. More than kQueue that wait are lost, as in a receiver that overruns.
  void ask(const BusItem& request);
  // The next one that is to be obeyed at `tick`; none: nothing is there, or the world runs first.
  std::optional<BusItem> next(std::int64_t tick);
  // The tick up to which the world may run.
  std::int64_t granted_tick() const { return granted_tick_; }

  // An answer that waits for its step.
  void hold(const Answer& answer) { answers_.push_back(answer); }
  // Those that may leave at `tick`.
  std::vector<Answer> released(std::int64_t tick);

  // The world stands at `tick` now, whatever was granted: it will not move again.
  void restart(std::int64_t tick) { granted_tick_ = tick; }
  // The same after a reset or restore: a cycle begins, with what waits. Answers that wait leave.
  void begin_era(std::int64_t tick) {
    restart(tick);
    asked_.clear();
    paid_ = false;
  }
  // What still waits, once the gate is no more.
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
  bool paid_ = false;    // the first request: its period is over
};

}  // namespace visum::bus

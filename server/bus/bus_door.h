// The buses as the lockstep and clients' requests see them.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/messages.h"
#include "server/bus/cycle_gate.h"

namespace visum::bus {

// The seam between the sessions and the buses. addresses() and exchanges() may be called on the sessions'
// thread; addresses() does not change once sessions are served. dropped() may be called on any thread. All
// other functions belong to lockstep, where one thread does everything; they are called between ticks. Buses
// (buses.h) says what they mean.
class BusDoor {
 public:
  virtual ~BusDoor() = default;

  virtual const std::vector<protocol::PartBus>& addresses() const = 0;
  // How many telegrams the modules of each of these parts have got so far.
  virtual std::vector<protocol::Exchange> exchanges() const = 0;
  bool has(const std::string& part) const {
    return std::ranges::find(addresses(), part, &protocol::PartBus::part) != addresses().end();
  }

  // Frames and lines that clients were sent and did not read in time. Any thread.
  virtual std::uint64_t dropped() const = 0;

  // Handles and answers all that the members' programs have written by now. Waits for what `streams` promise.
  virtual void settle(const std::vector<protocol::Stream>& streams) = 0;
  // Bytes written to pseudo terminals and CAN interfaces so far.
  virtual std::uint64_t said() = 0;
  // Fills in how much was written and read of those streams that are connections to a bus.
  virtual void fill_in(std::vector<protocol::Stream>& streams) = 0;

  // From now on, requests to this part's modules let the world run, by this rule.
  virtual void open_gate(std::uint32_t part, CycleRule rule) = 0;
  virtual void close_gate(std::uint32_t part) = 0;
  // The tick up to which the part's gate lets the world run.
  virtual std::int64_t granted_tick(std::uint32_t part) const = 0;
};

// A world without buses.
class NoBuses final : public BusDoor {
 public:
  // It has no state, so one is enough for all.
  static NoBuses& instance() {
    static NoBuses none;
    return none;
  }

  const std::vector<protocol::PartBus>& addresses() const override { return addresses_; }
  std::vector<protocol::Exchange> exchanges() const override { return {}; }
  std::uint64_t dropped() const override { return 0; }
  void settle(const std::vector<protocol::Stream>&) override {}
  std::uint64_t said() override { return 0; }
  void fill_in(std::vector<protocol::Stream>&) override {}
  void open_gate(std::uint32_t, CycleRule) override {}
  void close_gate(std::uint32_t) override {}
  std::int64_t granted_tick(std::uint32_t) const override { return 0; }

 private:
  const std::vector<protocol::PartBus> addresses_{};
};

}  // namespace visum::bus

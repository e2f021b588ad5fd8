// The daemon's buses, or none: what the loop serves between ticks, and what the lockstep sees of them.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "server/bus/bus_door.h"
#include "server/bus/buses.h"
#include "server/gateway/tick_side.h"

namespace visum::gateway {

// Lives on the tick's thread; only addresses(), exchanges(), names() and dropped() may be called on others,
// once open() is done. Until then, and where the daemon has no buses, each function does nothing.
class DaemonBuses final : public bus::BusDoor {
 public:
  explicit DaemonBuses(TickSide& tick_side) : tick_side_(tick_side) {}

  // `wake` is called on the buses' thread, as soon as something came. Throws std::runtime_error that names
  // what cannot be opened.
  void open(cycle::Simulation& simulation, const std::vector<bus::BusAddress>& addresses,
            std::function<void()> wake);
  // Ends the buses' thread, which calls `wake`.
  void close() { buses_.reset(); }

  bool are_open() const { return buses_.has_value(); }
  const bus::BusNames& names() const;
  // Handles what came between ticks. The first frame starts the time. True: there was something.
  bool serve();
  void serve_until(std::chrono::steady_clock::time_point due) { buses_->serve_until(due); }  // if are_open()
  void after_tick() {
    if (buses_) buses_->after_tick();
  }

  // BusDoor
  const std::vector<protocol::PartBus>& addresses() const override;
  std::vector<protocol::Exchange> exchanges() const override {
    return buses_ ? buses_->exchanges() : bus::NoBuses::instance().exchanges();
  }
  std::uint64_t dropped() const override { return buses_ ? buses_->dropped() : 0; }
  void settle(const std::vector<protocol::Stream>& streams) override;
  std::uint64_t said() override { return buses_ ? buses_->said() : 0; }
  void fill_in(std::vector<protocol::Stream>& streams) override {
    if (buses_) buses_->fill_in(streams);
  }
  void open_gate(std::uint32_t part, bus::CycleRule rule) override;
  void close_gate(std::uint32_t part) override {
    if (buses_) buses_->close_gate(part);
  }
  std::int64_t granted_tick(std::uint32_t part) const override {
    return buses_ ? buses_->granted_tick(part) : 0;
  }

 private:
  TickSide& tick_side_;
  std::optional<bus::Buses> buses_;
};

}  // namespace visum::gateway

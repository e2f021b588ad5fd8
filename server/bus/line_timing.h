// Tells when telegrams get through a line that is not ideal, in simulated time. They take turns, each for as
// long as its bits take. A serial line has a pair of wires for each direction, a CAN bus one for both.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "hwparts/powercube/can_codec.h"
#include "hwparts/powercube/serial_codec.h"
#include "server/bus/address.h"

namespace visum::bus {

class LineTiming {
 public:
  enum class Way { kToModules, kFromModules };

  explicit LineTiming(const BusTiming& timing) : timing_(timing) {}

  // Takes the line for a telegram that is ready at `now_ns`, and returns when it has passed. To be called
  // once that time has come, not earlier.
  std::int64_t pass(const powercube::Telegram& telegram, powercube::BusFraming framing, Way way,
                    std::int64_t now_ns) {
    const double bits = framing == powercube::BusFraming::kSerial
                            ? kBitsPerByte * static_cast<double>(powercube::encode_serial(telegram).size)
                            : kCanOverhead + 8.0 * telegram.message.size;
    const double ns = timing_.baud > 0.0 ? 1e9 * bits / timing_.baud : 0.0;
    const bool back = framing == powercube::BusFraming::kSerial && way == Way::kFromModules;
    auto& free_ns = back ? free_back_ns_ : free_ns_;
    free_ns = std::max(free_ns, now_ns) + std::llround(ns);
    return free_ns;
  }
  std::int64_t delay_ns() const { return timing_.delay_ns; }
  bool ideal() const { return timing_.ideal(); }
  void restart() { free_ns_ = free_back_ns_ = 0; }  // time goes back

 private:
  static constexpr double kBitsPerByte = 10.0;  // 8N1
  static constexpr double kCanOverhead = 47.0;  // bits of a standard frame, without stuffing
  BusTiming timing_;
  std::int64_t free_ns_ = 0, free_back_ns_ = 0;
};

}  // namespace visum::bus

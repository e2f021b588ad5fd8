// Telegrams as CAN frames, and CAN frames as the text lines of slcan (Lawicel's protocol, which slcand and
// python-can speak). Pure functions.
//
// clang-format off
//   CAN id, of module n (hex)   0A0 + n answer, 0C0 + n GET (command 0A only), 0E0 + n SET, 060 + n state,
//                               100 broadcast
//   slcan frame                 "t" id(3 hex) length(1 digit) data(2 hex each) CR
//                               t0C120A1D\r is 0c1 [2] 0a 1d
//   slcan commands              "O" open, "C" close, "L" listen only, "S"n bit rate, "V" version,
//                               "N" serial number, "F" flags
//   slcan answers               CR, or BEL (07) to a wrong command; "z" CR to a frame that was sent
// clang-format on
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "hwparts/powercube/message.h"
#include "hwparts/powercube/serial_codec.h"

namespace visum::powercube {

struct CanFrame {
  std::uint32_t id = 0;
  bool extended = false;  // 29-bit id
  bool remote = false;
  std::uint8_t size = 0;
  std::array<std::uint8_t, 8> data{};
  bool operator==(const CanFrame&) const = default;
};

// Nothing for a frame that is not PowerCube's: another id, a remote frame, an empty one.
std::optional<Telegram> from_can(const CanFrame& frame);
CanFrame to_can(const Telegram& telegram);

inline constexpr std::size_t kMaxSlcanBytes =
    32;  // of a line; the longest, an extended frame with a time stamp, has 31

struct SlcanDecoded {
  enum class Kind { kFrame, kOpen, kListen, kClose, kSet, kVersion, kSerialNumber, kFlags };
  Progress progress = Progress::kNeedsMore;
  std::size_t taken = 0;  // as in SerialDecoded
  Kind kind = Kind::kFrame;
  CanFrame frame;  // kFrame
};
SlcanDecoded decode_slcan(std::span<const std::uint8_t> bytes);

struct SlcanBytes {
  std::size_t size = 0;
  std::array<std::uint8_t, kMaxSlcanBytes> data{};
  std::span<const std::uint8_t> bytes() const { return {data.data(), size}; }
};
SlcanBytes encode_slcan(const CanFrame& frame);

}  // namespace visum::powercube

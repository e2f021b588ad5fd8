// Telegrams as bytes on an RS-232 line, 8N1, and back. Pure functions.
//
//   frame = STX(02) H0 esc(H1) esc(D0 .. Dn-1) esc(BCC) ETX(03)
//   H0    = 04 | id>>3 to a module, 08 | id>>3 from one          H1 = (id & 7)<<5 | n,  n = 1..8
//   esc   = 02 -> 10 82, 03 -> 10 83, 10 -> 10 90                BCC = (s + (s>>8)) & FF, s = H0 + H1 + ΣD
//
// Example: module 1, "get parameter 1D" is 02 04 22 0a 1d 4d 03.
//
// Real clients bend these rules, and real modules let them (m5api, Player, CARMEN, ROS amtec, RobWork, UPM):
// - Clients use four formulas for the BCC, so a wrong one is never a reason to refuse a frame.
// - Player and its heirs do not escape H1, not even 02 and 03. The byte behind H0 is taken as it is, unless
//   it is 10.
// - RobWork's n counts the escapes, so n may be larger than the data, never smaller.
// The encoder follows m5api: escaped headers, its BCC, exact n.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "hwparts/powercube/message.h"

namespace visum::powercube {

inline constexpr std::size_t kMaxSerialBytes =
    22;  // of a frame with its escapes; m5api's buffers have no room for more

enum class Progress { kComplete, kNeedsMore, kBad };

struct SerialDecoded {
  Progress progress = Progress::kNeedsMore;
  // The number of bytes to drop: the frame's, noise, or 0. A caller drops them and goes on. It never gets
  // stuck, since kNeedsMore is the answer only to fewer than kMaxSerialBytes that may still become a frame.
  std::size_t taken = 0;
  Telegram telegram;         // kComplete
  bool checksum_ok = false;  // kComplete: the BCC is m5api's
};

SerialDecoded decode_serial(std::span<const std::uint8_t> bytes);

struct SerialBytes {
  std::size_t size = 0;
  std::array<std::uint8_t, kMaxSerialBytes> data{};
  std::span<const std::uint8_t> bytes() const { return {data.data(), size}; }
};

// The message must have 1 to 8 bytes. A serial line has no kState: it is encoded as an answer.
SerialBytes encode_serial(const Telegram& telegram);

}  // namespace visum::powercube

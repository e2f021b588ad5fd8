// A message on a PowerCube bus: up to eight data bytes to or from one module. Byte 0 is the command, byte 1
// the parameter or motion mode, and the rest its value, little-endian; floats are IEEE-754 binary32. The same
// bytes travel over CAN (can_codec.h) and RS-232 (serial_codec.h). The format is taken from the sources of
// m5api's clients. Plain values.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>

namespace visum::powercube {

inline constexpr std::size_t kMaxData = 8;
inline constexpr int kMaxModule = 31;  // ids 1..31; on RS-232, 0 addresses all

struct Message {
  std::uint8_t size = 0;
  std::array<std::uint8_t, kMaxData> data{};

  Message() = default;
  Message(std::initializer_list<std::uint8_t> bytes) {
    for (const auto byte : bytes) put(byte);
  }
  std::uint8_t command() const { return data[0]; }  // the message must not be empty
  std::span<const std::uint8_t> bytes() const { return {data.data(), size}; }
  void put(std::uint8_t byte) {
    if (size < kMaxData) data[size++] = byte;
  }
  bool operator==(const Message&) const = default;
};

// A message with its address and its role on the bus.
struct Telegram {
  enum class Kind : std::uint8_t {
    kGet,        // host to module, command 0A
    kSet,        // host to module, every other command
    kBroadcast,  // host to all; never answered
    kAnswer,     // module to host
    kState,      // module to host, unasked: the state word. CAN only
  };
  Kind kind = Kind::kSet;
  std::uint8_t module = 0;  // 1..31; broadcasts: 0
  Message message;
  bool operator==(const Telegram&) const = default;
};

inline bool from_module(Telegram::Kind kind) {
  return kind == Telegram::Kind::kAnswer || kind == Telegram::Kind::kState;
}

// Appends a value of 1, 2 or 4 bytes.
template <typename T>
requires std::integral<T> || std::same_as<T, float>
void put_value(Message& message, T value) {
  if constexpr (std::same_as<T, float>) {
    put_value(message, std::bit_cast<std::uint32_t>(value));
  } else {
    const auto bits = static_cast<std::uint64_t>(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) message.put(static_cast<std::uint8_t>(bits >> (8 * i)));
  }
}

// Reads a value that begins at byte `at`; the message must be long enough.
template <typename T>
requires std::integral<T> || std::same_as<T, float> T value_at(const Message& message, std::size_t at) {
  if constexpr (std::same_as<T, float>) {
    return std::bit_cast<float>(value_at<std::uint32_t>(message, at));
  } else {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i)
      bits |= static_cast<std::uint64_t>(message.data[at + i]) << (8 * i);
    return static_cast<T>(bits);
  }
}

// The commands (byte 0).
namespace command {
inline constexpr std::uint8_t kReset = 0x00;
inline constexpr std::uint8_t kHome = 0x01;
inline constexpr std::uint8_t kHalt = 0x02;
inline constexpr std::uint8_t kInternal = 0x04;
inline constexpr std::uint8_t kWatchdog = 0x07;
inline constexpr std::uint8_t kSetParameter = 0x08;
inline constexpr std::uint8_t kRecalcPid = 0x09;  // addressed; as a broadcast it sets the baud rate
inline constexpr std::uint8_t kGetParameter = 0x0A;
inline constexpr std::uint8_t kSetMove = 0x0B;
inline constexpr std::uint8_t kSavePosition = 0x0E;
inline constexpr std::uint8_t kStartMove = 0x0F;
inline constexpr std::uint8_t kSaveParameters = 0x10;
inline constexpr std::uint8_t kResetTime = 0x12;
}  // namespace command

inline constexpr std::uint8_t kDone = 0x64;  // 'd', third byte of an answer to SETPARAM and SETMOVE

}  // namespace visum::powercube

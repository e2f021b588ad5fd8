#include "hwparts/powercube/serial_codec.h"

#include <algorithm>

namespace visum::powercube {
namespace {

constexpr std::uint8_t kStx = 0x02, kEtx = 0x03, kDle = 0x10, kShift = 0x80;
constexpr std::uint8_t kToModule = 0x04, kFromModule = 0x08, kDirection = 0xFC;

bool is_special(std::uint8_t byte) {
  return byte == kStx || byte == kEtx || byte == kDle;
}

// The bytes between STX and ETX without their escapes: H0, H1, data, BCC.
struct Body {
  std::size_t size = 0;
  std::array<std::uint8_t, kMaxSerialBytes> data{};
};

SerialDecoded bad(std::size_t taken) {
  return {Progress::kBad, taken, {}, false};
}

// m5api's BCC: a 16-bit sum whose two bytes are added.
std::uint8_t checksum(std::span<const std::uint8_t> bytes) {
  unsigned sum = 0;
  for (const auto byte : bytes) sum += byte;
  return static_cast<std::uint8_t>(sum + (sum >> 8));
}

Telegram::Kind kind_of(bool answers, std::uint8_t module, std::uint8_t command) {
  if (answers) return Telegram::Kind::kAnswer;
  if (module == 0) return Telegram::Kind::kBroadcast;
  return command == command::kGetParameter ? Telegram::Kind::kGet : Telegram::Kind::kSet;
}

// Decodes a body whose ETX has come. With STX, ETX and escapes the frame has `wire` bytes.
SerialDecoded interpret(const Body& body, std::size_t wire) {
  constexpr std::size_t kHeader = 2, kCheck = 1;
  if (body.size < kHeader + 1 + kCheck) return bad(wire);
  const std::size_t count = body.size - kHeader - kCheck;
  const auto h0 = body.data[0], h1 = body.data[1];
  const std::size_t announced = h1 & 0x0F;
  // The header announces fewer bytes than came: a broken frame begins here, with a whole one behind it.
  if (count > kMaxData || announced < count) return bad(1);
  SerialDecoded decoded{Progress::kComplete, wire, {}, false};
  auto& telegram = decoded.telegram;
  telegram.module = static_cast<std::uint8_t>((h0 & 3) << 3 | h1 >> 5);
  for (std::size_t i = 0; i < count; ++i) telegram.message.put(body.data[kHeader + i]);
  const bool answers = (h0 & kDirection) == kFromModule;
  if (answers && telegram.module == 0) return bad(wire);
  telegram.kind = kind_of(answers, telegram.module, telegram.message.command());
  decoded.checksum_ok = body.data[body.size - 1] == checksum(std::span(body.data).first(body.size - kCheck));
  return decoded;
}

}  // namespace

SerialDecoded decode_serial(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return {};
  if (bytes[0] != kStx) {
    const auto next = std::ranges::find(bytes, kStx);
    return bad(static_cast<std::size_t>(next - bytes.begin()));
  }
  Body body;
  const std::size_t end = std::min(bytes.size(), kMaxSerialBytes);
  for (std::size_t at = 1; at < end; ++at) {
    auto byte = bytes[at];
    if (body.size == 0) {
      if ((byte & kDirection) != kToModule && (byte & kDirection) != kFromModule) return bad(at);
    } else if (byte == kDle) {
      if (++at == end) break;
      byte = static_cast<std::uint8_t>(bytes[at] - kShift);
      if (!is_special(byte)) return bad(bytes[at] == kStx ? at : at + 1);
    } else if (body.size > 1 && byte == kEtx) {
      return interpret(body, at + 1);
    } else if (body.size > 1 && byte == kStx) {
      return bad(at);
    }
    body.data[body.size++] = byte;
  }
  if (bytes.size() < kMaxSerialBytes) return {};
  return bad(1);
}

SerialBytes encode_serial(const Telegram& telegram) {
  const auto& message = telegram.message;
  Body body;
  const bool answers = from_module(telegram.kind);
  body.data[0] = static_cast<std::uint8_t>((answers ? kFromModule : kToModule) | telegram.module >> 3);
  body.data[1] = static_cast<std::uint8_t>((telegram.module & 7) << 5 | message.size);
  std::ranges::copy(message.bytes(), body.data.begin() + 2);
  body.size = 2u + message.size;
  body.data[body.size] = checksum(std::span(body.data).first(body.size));
  ++body.size;

  SerialBytes wire;
  wire.data[wire.size++] = kStx;
  for (std::size_t i = 0; i < body.size; ++i) {
    const auto byte = body.data[i];
    if (is_special(byte)) wire.data[wire.size++] = kDle;
    wire.data[wire.size++] = static_cast<std::uint8_t>(is_special(byte) ? byte + kShift : byte);
  }
  wire.data[wire.size++] = kEtx;
  return wire;
}

}  // namespace visum::powercube

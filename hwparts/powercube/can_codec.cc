#include "hwparts/powercube/can_codec.h"

#include <algorithm>
#include <cctype>

namespace visum::powercube {
namespace {

constexpr std::uint32_t kStateId = 0x060, kAnswerId = 0x0A0, kGetId = 0x0C0, kSetId = 0x0E0,
                        kBroadcastId = 0x100;
constexpr std::uint32_t kModuleBits = 0x1F;
constexpr std::uint8_t kReturn = '\r';

std::optional<Telegram::Kind> kind_of(std::uint32_t base) {
  switch (base) {
    case kStateId:
      return Telegram::Kind::kState;
    case kAnswerId:
      return Telegram::Kind::kAnswer;
    case kGetId:
      return Telegram::Kind::kGet;
    case kSetId:
      return Telegram::Kind::kSet;
    default:
      return std::nullopt;
  }
}

std::uint32_t base_of(Telegram::Kind kind) {
  switch (kind) {
    case Telegram::Kind::kState:
      return kStateId;
    case Telegram::Kind::kAnswer:
      return kAnswerId;
    case Telegram::Kind::kGet:
      return kGetId;
    case Telegram::Kind::kSet:
      return kSetId;
    case Telegram::Kind::kBroadcast:
      break;
  }
  return kBroadcastId;
}

std::optional<std::uint32_t> hexadecimal(std::span<const std::uint8_t> digits) {
  std::uint32_t value = 0;
  for (const auto digit : digits) {
    if (!std::isxdigit(digit)) return std::nullopt;
    const int nibble = std::isdigit(digit) ? digit - '0' : std::tolower(digit) - 'a' + 10;
    value = value << 4 | static_cast<std::uint32_t>(nibble);
  }
  return value;
}

// A line "t", "r", "T" or "R" with id, length, data and, where the adapter stamps received frames, four
// digits of time.
std::optional<CanFrame> parse_frame(std::span<const std::uint8_t> line) {
  CanFrame frame;
  frame.extended = line[0] == 'T' || line[0] == 'R';
  frame.remote = line[0] == 'r' || line[0] == 'R';
  const std::size_t digits = frame.extended ? 8 : 3;
  if (line.size() < 1 + digits + 1) return std::nullopt;
  const auto id = hexadecimal(line.subspan(1, digits));
  const auto length = hexadecimal(line.subspan(1 + digits, 1));
  if (!id || !length || *length > 8 || *id > (frame.extended ? 0x1FFFFFFFu : 0x7FFu)) return std::nullopt;
  frame.id = *id;
  frame.size = static_cast<std::uint8_t>(*length);
  const auto rest = line.subspan(1 + digits + 1);
  const std::size_t data = frame.remote ? 0 : 2u * frame.size;
  if (rest.size() != data && rest.size() != data + 4) return std::nullopt;
  for (std::size_t i = 0; i < data / 2; ++i) {
    const auto byte = hexadecimal(rest.subspan(2 * i, 2));
    if (!byte) return std::nullopt;
    frame.data[i] = static_cast<std::uint8_t>(*byte);
  }
  return frame;
}

struct Verb {
  char letter;
  SlcanDecoded::Kind kind;
};
constexpr std::array<Verb, 12> kVerbs{{
    {'O', SlcanDecoded::Kind::kOpen},
    {'L', SlcanDecoded::Kind::kListen},
    {'C', SlcanDecoded::Kind::kClose},
    {'S', SlcanDecoded::Kind::kSet},  // bit rate, by number or by register
    {'s', SlcanDecoded::Kind::kSet},
    {'M', SlcanDecoded::Kind::kSet},  // acceptance filter
    {'m', SlcanDecoded::Kind::kSet},
    {'Z', SlcanDecoded::Kind::kSet},  // time stamps: this side gives none
    {'X', SlcanDecoded::Kind::kSet},  // polling
    {'V', SlcanDecoded::Kind::kVersion},
    {'v', SlcanDecoded::Kind::kVersion},
    {'N', SlcanDecoded::Kind::kSerialNumber},
}};

}  // namespace

std::optional<Telegram> from_can(const CanFrame& frame) {
  if (frame.extended || frame.remote || frame.size == 0) return std::nullopt;
  Telegram telegram;
  if (frame.id == kBroadcastId) {
    telegram.kind = Telegram::Kind::kBroadcast;
  } else {
    const auto kind = kind_of(frame.id & ~kModuleBits);
    telegram.module = static_cast<std::uint8_t>(frame.id & kModuleBits);
    if (!kind || telegram.module == 0) return std::nullopt;
    telegram.kind = *kind;
  }
  for (std::size_t i = 0; i < std::min<std::size_t>(frame.size, kMaxData); ++i)
    telegram.message.put(frame.data[i]);
  return telegram;
}

CanFrame to_can(const Telegram& telegram) {
  CanFrame frame;
  frame.id = base_of(telegram.kind) + telegram.module;
  frame.size = telegram.message.size;
  frame.data = telegram.message.data;
  return frame;
}

SlcanDecoded decode_slcan(std::span<const std::uint8_t> bytes) {
  const auto end = std::ranges::find(bytes, kReturn);
  if (end == bytes.end()) {
    if (bytes.size() < kMaxSlcanBytes) return {};
    return {Progress::kBad, bytes.size(), {}, {}};
  }
  auto line = bytes.first(static_cast<std::size_t>(end - bytes.begin()));
  SlcanDecoded decoded{Progress::kComplete, line.size() + 1, {}, {}};
  while (!line.empty() && (line[0] == '\n' || line[0] == '\a')) line = line.subspan(1);
  if (line.empty()) {  // clients send empty lines to flush theirs
    decoded.kind = SlcanDecoded::Kind::kSet;
    return decoded;
  }
  if (line[0] == 't' || line[0] == 'T' || line[0] == 'r' || line[0] == 'R') {
    const auto frame = parse_frame(line);
    if (frame) decoded.frame = *frame;
    if (!frame) decoded.progress = Progress::kBad;
    return decoded;
  }
  if (line[0] == 'F' && line.size() == 1) {
    decoded.kind = SlcanDecoded::Kind::kFlags;
    return decoded;
  }
  const auto verb = std::ranges::find(kVerbs, static_cast<char>(line[0]), &Verb::letter);
  if (verb == kVerbs.end()) decoded.progress = Progress::kBad;
  if (verb != kVerbs.end()) decoded.kind = verb->kind;
  return decoded;
}

SlcanBytes encode_slcan(const CanFrame& frame) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  SlcanBytes line;
  const auto put = [&](char c) { line.data[line.size++] = static_cast<std::uint8_t>(c); };
  put(frame.extended ? (frame.remote ? 'R' : 'T') : (frame.remote ? 'r' : 't'));
  for (int digit = frame.extended ? 7 : 2; digit >= 0; --digit) put(kDigits[(frame.id >> (4 * digit)) & 0xF]);
  put(static_cast<char>('0' + frame.size));
  for (std::size_t i = 0; i < frame.size && !frame.remote; ++i) {
    put(kDigits[frame.data[i] >> 4]);
    put(kDigits[frame.data[i] & 0xF]);
  }
  put('\r');
  return line;
}

}  // namespace visum::powercube

#include "protocol/stop_datagram.h"

#include <algorithm>
#include <string_view>

namespace visum::protocol {
namespace {

constexpr std::string_view kMagic = "visumSTP";
constexpr std::uint8_t kVersion = 1;
constexpr std::string_view kProofOf = "visum stop 1";

template <typename Range>
void append(std::vector<std::byte>& to, const Range& range) {
  const auto bytes = std::as_bytes(std::span(range.data(), range.size()));
  to.insert(to.end(), bytes.begin(), bytes.end());
}

class Writer {
 public:
  // The kind of a datagram is its place in the variant, counted from 1.
  Writer(std::vector<std::byte>& to, std::size_t kind) : to_(to) {
    append(to_, kMagic);
    byte(kVersion);
    byte(static_cast<std::uint8_t>(kind + 1));
  }
  void operator()(const StopAsk& datagram) {
    append(to_, datagram.nonce);
    to_.resize(kStopAskBytes);
  }
  void operator()(const StopChallenge& datagram) {
    append(to_, datagram.nonce);
    append(to_, datagram.cookie);
    byte(static_cast<std::uint8_t>(datagram.proof));
  }
  void operator()(const StopOrder& datagram) {
    append(to_, datagram.nonce);
    append(to_, datagram.cookie);
    append(to_, datagram.proof);
    const auto part = std::string_view(datagram.part).substr(0, kMaxStopPart);
    byte(static_cast<std::uint8_t>(part.size()));
    append(to_, part);
    to_.resize(kStopOrderBytes);
  }
  void operator()(const StopLatched& datagram) { append(to_, datagram.nonce); }
  void operator()(const StopActed& datagram) {
    append(to_, datagram.nonce);
    const auto tick = static_cast<std::uint64_t>(datagram.tick);
    for (int i = 0; i < 8; ++i) byte(static_cast<std::uint8_t>(tick >> (8 * i)));
  }
  void operator()(const StopRefused& datagram) {
    append(to_, datagram.nonce);
    byte(static_cast<std::uint8_t>(datagram.why));
  }

 private:
  void byte(std::uint8_t value) { to_.push_back(std::byte{value}); }
  std::vector<std::byte>& to_;
};

// Reads from a datagram. Each function returns zeros once the bytes are used up.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  std::uint8_t byte() {
    std::array<std::byte, 1> one{};
    fill(one);
    return std::to_integer<std::uint8_t>(one[0]);
  }
  template <std::size_t N>
  void fill(std::array<std::byte, N>& to) {
    const auto from = take(N);
    if (from.size() == N) std::ranges::copy(from, to.begin());
  }
  std::string text(std::size_t length) {
    const auto from = take(length);
    return {reinterpret_cast<const char*>(from.data()), from.size()};
  }
  std::int64_t number() {
    std::uint64_t value = 0;
    for (int i = 0; i < 8; ++i) value |= std::uint64_t{byte()} << (8 * i);
    return static_cast<std::int64_t>(value);
  }
  // True if the datagram was long enough and all that is left of it is zeros.
  bool ends_well() const {
    return good_ && std::ranges::all_of(bytes_, [](std::byte byte) { return byte == std::byte{0}; });
  }
  std::size_t left() const { return bytes_.size(); }

 private:
  std::span<const std::byte> take(std::size_t length) {
    good_ = good_ && length <= bytes_.size();
    if (!good_) return {};
    const auto taken = bytes_.first(length);
    bytes_ = bytes_.subspan(length);
    return taken;
  }
  std::span<const std::byte> bytes_;
  bool good_ = true;
};

std::optional<StopDatagram> read(Reader& from, std::uint8_t kind) {
  StopNonce nonce{};
  from.fill(nonce);
  switch (kind) {
    case 1:
      return StopAsk{nonce};
    case 2: {
      StopChallenge challenge{nonce};
      from.fill(challenge.cookie);
      challenge.proof = static_cast<StopProof>(from.byte());
      if (challenge.proof > StopProof::kSession) return std::nullopt;
      return challenge;
    }
    case 3: {
      StopOrder order{nonce};
      from.fill(order.cookie);
      from.fill(order.proof);
      order.part = from.text(from.byte());
      return order;
    }
    case 4:
      return StopLatched{nonce};
    case 5:
      return StopActed{nonce, from.number()};
    case 6: {
      const auto why = static_cast<StopRefusal>(from.byte());
      if (why < StopRefusal::kCookie || why > StopRefusal::kBusy) return std::nullopt;
      return StopRefused{nonce, why};
    }
    default:
      return std::nullopt;
  }
}

}  // namespace

std::vector<std::byte> encode(const StopDatagram& datagram) {
  std::vector<std::byte> bytes;
  bytes.reserve(kStopOrderBytes);  // the longest; without it GCC 12 warns at -O3 of an overflow
  std::visit(Writer(bytes, datagram.index()), datagram);
  return bytes;
}

std::optional<StopDatagram> decode_stop(std::span<const std::byte> bytes) {
  Reader from(bytes);
  if (from.text(kMagic.size()) != kMagic || from.byte() != kVersion) return std::nullopt;
  const auto kind = from.byte();
  if (kind == 1 && bytes.size() != kStopAskBytes) return std::nullopt;
  if (kind == 3 && bytes.size() != kStopOrderBytes) return std::nullopt;
  auto datagram = read(from, kind);
  const bool padded = kind == 1 || kind == 3;
  if (!from.ends_well() || (!padded && from.left() > 0)) return std::nullopt;
  return datagram;
}

KeyedHash stop_proof(const std::string& token, const KeyedHash& cookie, const std::string& part) {
  std::vector<std::byte> message;
  append(message, kProofOf);
  append(message, cookie);
  append(message, part);
  return keyed_hash(std::as_bytes(std::span(token.data(), token.size())), message);
}

}  // namespace visum::protocol

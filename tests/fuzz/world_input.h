// How bytes are steps of sessions in front of a world (fuzz_world.cc), for the target and for the program
// that writes its corpus.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/codec.h"
#include "protocol/limits.h"

namespace visum::testing {

inline constexpr std::size_t kWorldSessions = 4;

// An observer, two controllers, an administrator.
inline protocol::Hello hello_of(std::size_t session) {
  constexpr protocol::Role kRoles[kWorldSessions] = {protocol::Role::kObserver, protocol::Role::kController,
                                                     protocol::Role::kController, protocol::Role::kAdmin};
  return {1, protocol::kProtocolVersion, "session " + std::to_string(session), kRoles[session], ""};
}

struct WorldStep {
  enum class Kind { kRequest = 0, kTicks = 1, kLeave = 2 };
  std::size_t session = 0;
  Kind kind = Kind::kRequest;
  std::vector<std::byte> frame{};  // kRequest: header and payload
  int ticks = 0;                   // kTicks: 1 to 16
  bool in_good_order = false;      // kLeave
};

class WorldSteps {
 public:
  explicit WorldSteps(std::span<const std::byte> bytes) : bytes_(bytes) {}

  // Nothing: the bytes are at their end. Any bytes are steps.
  std::optional<WorldStep> next() {
    if (bytes_.empty()) return {};
    const auto first = take();
    WorldStep step{first & 3u, static_cast<WorldStep::Kind>((first >> 2) & 3u)};
    if (step.kind == WorldStep::Kind::kTicks) step.ticks = static_cast<int>(first >> 4) + 1;
    if (step.kind == WorldStep::Kind::kLeave) step.in_good_order = (first >> 4) & 1u;
    if (step.kind == WorldStep::Kind::kTicks || step.kind == WorldStep::Kind::kLeave) return step;
    step.kind = WorldStep::Kind::kRequest;  // the fourth value is one, too
    const auto low = take(), high = take();
    const auto size = std::min<std::size_t>(low | (high << 8), bytes_.size());
    for (std::size_t i = 0; i < protocol::kHeaderBytes; ++i)
      step.frame.push_back(static_cast<std::byte>((size >> (8 * i)) & 0xFF));
    step.frame.insert(step.frame.end(), bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(size));
    bytes_ = bytes_.subspan(size);
    return step;
  }

 private:
  unsigned take() {
    if (bytes_.empty()) return 0;
    const auto byte = static_cast<unsigned>(bytes_.front());
    bytes_ = bytes_.subspan(1);
    return byte;
  }

  std::span<const std::byte> bytes_;
};

// The other way round: makes an input.
class WorldInput {
 public:
  explicit WorldInput(unsigned clock) { bytes_.push_back(static_cast<std::byte>(clock)); }

  WorldInput& ask(std::size_t session, const protocol::Request& request) {
    std::vector<std::byte> frame;
    encode_request(++requests_, request, frame);
    const auto size = frame.size() - protocol::kHeaderBytes;
    put(session);
    put(size & 0xFF);
    put(size >> 8);
    bytes_.insert(bytes_.end(), frame.begin() + protocol::kHeaderBytes, frame.end());
    return *this;
  }
  WorldInput& tick(unsigned ticks) { return put(1u << 2 | (ticks - 1) << 4); }
  WorldInput& leave(std::size_t session, bool in_good_order) {
    return put(session | 2u << 2 | (in_good_order ? 1u << 4 : 0u));
  }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  WorldInput& put(std::size_t byte) {
    bytes_.push_back(static_cast<std::byte>(byte));
    return *this;
  }

  std::vector<std::byte> bytes_;
  std::uint64_t requests_ = 0;
};

}  // namespace visum::testing

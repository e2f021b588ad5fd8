// The kinds of clocks that pace a world, with their names in scene files, options, messages and recordings,
// and the bounds of realtime's speed.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace visum::scene {

enum class ClockKind { kRealtime, kLockstep, kFree };

inline constexpr std::array<std::string_view, 3> kClockNames{"realtime", "lockstep", "free"};

// Simulated seconds per second of wall time.
inline constexpr double kLeastSpeed = 1e-3, kMostSpeed = 1e3;

constexpr std::string_view name_of(ClockKind clock) {
  return kClockNames[static_cast<std::size_t>(clock)];
}

// `name` must be one of kClockNames.
constexpr ClockKind clock_of(std::string_view name) {
  std::size_t kind = 0;
  while (kind + 1 < kClockNames.size() && kClockNames[kind] != name) ++kind;
  return static_cast<ClockKind>(kind);
}

}  // namespace visum::scene

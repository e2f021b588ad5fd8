// A whole server without sockets, threads and a wall clock, in bad weather: a handful of clients, late and
// clogged and broken connections, and every order of the work on both sides of the mailbox, all from one
// seed. The same seed is the same storm to the bit.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "tests/gateway/storm/oracle.h"

namespace visum::storm {

struct Outcome {
  std::string broken;  // the first claim that did not hold; empty: all held
  std::uint64_t digest = 0;
  std::uint64_t servers = 0;  // how many there were: all but the last have crashed
  std::int64_t ticks = 0;
  Oracle::Counts counts;
};

// `record`: each server writes what happens into this file; empty: it does not.
Outcome run_storm(std::uint64_t seed, std::int64_t duration_ms, const std::filesystem::path& record = {});

}  // namespace visum::storm

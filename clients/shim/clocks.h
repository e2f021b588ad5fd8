// Converts between the program's clocks and simulated time. Pure functions; any thread.
#pragma once

#include <time.h>

#include <cstdint>

#include "clients/shim/channel.h"

namespace visum::shim {

inline constexpr std::int64_t kSecond_ns = 1'000'000'000;

// The reading of a clock at simulated time 0. False for clocks that stay the host's (processor time, a
// device's clock).
bool base_of(clockid_t clock, std::int64_t& base_ns);

inline timespec to_timespec(std::int64_t ns) {
  return {ns / kSecond_ns, ns % kSecond_ns};
}
// Times too far ahead to count, and invalid ones, become kNever.
std::int64_t to_ns(const timespec& time);
std::int64_t after_ns(std::int64_t from_ns, std::int64_t length_ns);  // kNever where that is beyond it
bool is_length(const timespec* time);                                 // false: the kernel would refuse it
// The simulated time at which `clock` shows `time`, or kNever. Only for clocks for which base_of() is true.
std::int64_t when(clockid_t clock, const timespec* time);

}  // namespace visum::shim

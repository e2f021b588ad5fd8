// Between the program's clocks and the simulated time.
#pragma once

#include <time.h>

#include <cstdint>

#include "clients/shim/channel.h"

namespace visum::shim {

inline constexpr std::int64_t kSecond_ns = 1'000'000'000;

// What a clock shows at simulated 0; false: it is none of ours (processor time, a device's clock).
bool base_of(clockid_t clock, std::int64_t& base_ns);

inline timespec to_timespec(std::int64_t ns) {
  return {ns / kSecond_ns, ns % kSecond_ns};
}
// Far futures, and what is no time at all, become kNever.
std::int64_t to_ns(const timespec& time);
std::int64_t after_ns(std::int64_t from_ns, std::int64_t length_ns);  // kNever where that is beyond it
bool is_length(const timespec* time);                                 // none that the kernel would refuse
// The simulated time at which `clock` shows `time`; kNever for none. Only for clocks of ours.
std::int64_t when(clockid_t clock, const timespec* time);

}  // namespace visum::shim

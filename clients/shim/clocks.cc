// clock_gettime, gettimeofday, time: the program's clocks show simulated time.
#include "clients/shim/clocks.h"

#include <errno.h>
#include <sys/time.h>

#include "clients/shim/real.h"
#include "clients/shim/turns.h"

namespace visum::shim {

bool base_of(clockid_t clock, std::int64_t& base_ns) {
  switch (clock) {
    case CLOCK_REALTIME:
    case CLOCK_REALTIME_COARSE:
    case CLOCK_REALTIME_ALARM:
    case CLOCK_TAI:
      base_ns = kRealtimeBase_ns;
      return true;
    case CLOCK_MONOTONIC:
    case CLOCK_MONOTONIC_RAW:
    case CLOCK_MONOTONIC_COARSE:
    case CLOCK_BOOTTIME:
    case CLOCK_BOOTTIME_ALARM:
      base_ns = kMonotonicBase_ns;
      return true;
    default:
      return false;
  }
}

std::int64_t to_ns(const timespec& time) {
  if (time.tv_sec < 0) return 0;
  if (time.tv_sec >= kNever / kSecond_ns - 1) return kNever;
  return time.tv_sec * kSecond_ns + time.tv_nsec;
}

std::int64_t after_ns(std::int64_t from_ns, std::int64_t length_ns) {
  return length_ns >= kNever - from_ns ? kNever : from_ns + length_ns;
}

bool is_length(const timespec* time) {
  return time && time->tv_sec >= 0 && time->tv_nsec >= 0 && time->tv_nsec < kSecond_ns;
}

std::int64_t when(clockid_t clock, const timespec* time) {
  std::int64_t base = 0;
  if (!time || !base_of(clock, base)) return kNever;
  const auto ns = to_ns(*time);
  return ns == kNever ? kNever : ns - base;
}

}  // namespace visum::shim

using namespace visum::shim;

VISUM_EXPORT int clock_gettime(clockid_t clock, timespec* time) noexcept {
  std::int64_t base = 0;
  if (!active() || !base_of(clock, base)) return VISUM_REAL(clock_gettime)(clock, time);
  note_look("clock_gettime");
  *time = to_timespec(base + now_ns());
  return 0;
}

VISUM_EXPORT int gettimeofday(timeval* __restrict time, void* __restrict zone) noexcept {
  if (!active()) return VISUM_REAL(gettimeofday)(time, zone);
  note_look("gettimeofday");
  const auto now = kRealtimeBase_ns + now_ns();
  *time = {now / kSecond_ns, now % kSecond_ns / 1000};
  return 0;
}

VISUM_EXPORT time_t time(time_t* to) noexcept {
  if (!active()) return VISUM_REAL(time)(to);
  note_look("time");
  const time_t now = (kRealtimeBase_ns + now_ns()) / kSecond_ns;
  if (to) *to = now;
  return now;
}

VISUM_EXPORT int timespec_get(timespec* time, int base) noexcept {
  if (!active() || base != TIME_UTC) return VISUM_REAL(timespec_get)(time, base);
  return clock_gettime(CLOCK_REALTIME, time) == 0 ? base : 0;
}

// nanosleep, clock_nanosleep, usleep, sleep and their like.
#include <errno.h>
#include <sched.h>
#include <threads.h>
#include <unistd.h>

#include "clients/shim/clocks.h"
#include "clients/shim/real.h"
#include "clients/shim/turns.h"

using namespace visum::shim;

namespace {

// Returns 0 or EINTR.
int sleep_until(const char* doing, std::int64_t deadline_ns) {
  if (deadline_ns <= now_ns()) note_look(doing);
  while (now_ns() < deadline_ns)
    if (!park({doing, deadline_ns})) return now_ns() < deadline_ns ? EINTR : 0;
  return 0;
}

// The error, as clock_nanosleep() gives it.
int sleep_for(const char* doing, const timespec* length, timespec* left) {
  if (!is_length(length)) return EINVAL;
  const auto deadline = after_ns(now_ns(), to_ns(*length));
  const int error = sleep_until(doing, deadline);
  if (error != 0 && left) *left = to_timespec(deadline - now_ns());
  return error;
}

int fail(int error) {
  if (error == 0) return 0;
  errno = error;
  return -1;
}

}  // namespace

VISUM_EXPORT int nanosleep(const timespec* length, timespec* left) {
  if (!active() || !length) return VISUM_REAL(nanosleep)(length, left);
  return fail(sleep_for("nanosleep", length, left));
}

VISUM_EXPORT int clock_nanosleep(clockid_t clock, int flags, const timespec* time, timespec* left) {
  std::int64_t base = 0;
  if (!active() || !time || !base_of(clock, base))
    return VISUM_REAL(clock_nanosleep)(clock, flags, time, left);
  if (!(flags & TIMER_ABSTIME)) return sleep_for("clock_nanosleep", time, left);
  return is_length(time) ? sleep_until("clock_nanosleep", when(clock, time)) : EINVAL;
}

VISUM_EXPORT int usleep(useconds_t us) {
  if (!active()) return VISUM_REAL(usleep)(us);
  const auto length = to_timespec(std::int64_t{us} * 1000);
  return fail(sleep_for("usleep", &length, nullptr));
}

VISUM_EXPORT unsigned int sleep(unsigned int seconds) {
  if (!active()) return VISUM_REAL(sleep)(seconds);
  const timespec length{seconds, 0};
  timespec left{};
  if (sleep_for("sleep", &length, &left) == 0) return 0;
  return static_cast<unsigned int>(left.tv_sec + (left.tv_nsec > 0 ? 1 : 0));
}

VISUM_EXPORT int thrd_sleep(const timespec* length, timespec* left) {
  if (!active() || !length) return VISUM_REAL(thrd_sleep)(length, left);
  const int error = sleep_for("thrd_sleep", length, left);
  return error == 0 ? 0 : error == EINTR ? -1 : -2;  // as C11 has it
}

VISUM_EXPORT int sched_yield() noexcept {
  if (!active()) return VISUM_REAL(sched_yield)();
  note_look("sched_yield");  // a yield cannot let another thread run: they wait for their turns
  return 0;
}

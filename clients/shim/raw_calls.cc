// What is asked of the kernel by syscall(): so libstdc++ waits for futures, semaphores and atomics.
#include <errno.h>
#include <linux/futex.h>
#include <stdarg.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>

#include "clients/shim/clocks.h"
#include "clients/shim/real.h"
#include "clients/shim/turns.h"

using namespace visum::shim;

namespace {

struct Call {
  long number, words[6];
};

long carry_out(const Call& call) {
  const auto& word = call.words;
  return VISUM_REAL(syscall)(call.number, word[0], word[1], word[2], word[3], word[4], word[5]);
}

long refuse(int error) {
  errno = error;
  return -1;
}

// Looks again when others have run: whoever wakes somebody by a futex has changed its word before.
long wait_until(const std::atomic<std::uint32_t>& word, std::uint32_t expected, std::int64_t deadline) {
  if (word.load() != expected) return refuse(EAGAIN);
  if (deadline <= now_ns()) note_look("futex");
  for (std::uint32_t flags = kRecheck; deadline > now_ns(); flags |= kAgain) {
    if (!park({"futex", deadline, flags})) return refuse(EINTR);
    if (word.load() != expected) return 0;
  }
  return refuse(ETIMEDOUT);
}

// futex(2).
long futex(const Call& call) {
  const auto operation = call.words[1] & FUTEX_CMD_MASK;
  if (operation != FUTEX_WAIT && operation != FUTEX_WAIT_BITSET) return carry_out(call);
  const auto* time = reinterpret_cast<const timespec*>(call.words[3]);
  if (!time) return blocked("futex", [&] { return carry_out(call); });
  if (!is_length(time)) return refuse(EINVAL);
  const auto clock = (call.words[1] & FUTEX_CLOCK_REALTIME) != 0 ? CLOCK_REALTIME : CLOCK_MONOTONIC;
  const auto deadline = operation == FUTEX_WAIT ? after_ns(now_ns(), to_ns(*time)) : when(clock, time);
  return wait_until(*reinterpret_cast<const std::atomic<std::uint32_t>*>(call.words[0]),
                    static_cast<std::uint32_t>(call.words[2]), deadline);
}

}  // namespace

VISUM_EXPORT long syscall(long number, ...) noexcept {
  Call call{number, {}};
  va_list list;
  va_start(list, number);
  for (long& word : call.words) word = va_arg(list, long);
  va_end(list);
  return active() && number == SYS_futex ? futex(call) : carry_out(call);
}

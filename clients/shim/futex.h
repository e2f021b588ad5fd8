// The kernel's futex between processes, by a direct system call: the shim intercepts pthread's calls and
// syscall() themselves.
#pragma once

#include <linux/futex.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdint>

#include "clients/shim/real.h"

namespace visum::shim {

// Returns 0 or an errno: EAGAIN (the word has changed already), EINTR, ETIMEDOUT.
inline int futex_wait(std::atomic<std::uint32_t>& word, std::uint32_t expected, std::int64_t patience_ns) {
  const timespec patience{patience_ns / 1'000'000'000, patience_ns % 1'000'000'000};
  const long done = VISUM_REAL(syscall)(SYS_futex, &word, FUTEX_WAIT, expected, &patience, nullptr, 0);
  return done == 0 ? 0 : errno;
}

inline void futex_wake(std::atomic<std::uint32_t>& word) {
  VISUM_REAL(syscall)(SYS_futex, &word, FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0);
}

}  // namespace visum::shim

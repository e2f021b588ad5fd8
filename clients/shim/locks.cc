// Mutexes, condition variables and semaphores. Time-outs are simulated; waits without one are announced to
// the scheduler.
#include <errno.h>
#include <pthread.h>
#include <semaphore.h>
#include <threads.h>

#include <algorithm>

#include "clients/shim/clocks.h"
#include "clients/shim/real.h"
#include "clients/shim/turns.h"

using namespace visum::shim;

namespace {

// Tries until it works or the deadline comes. `attempt` returns 0 or an errno; `busy` is the errno that means
// "try again".
template <typename Attempt>
int try_until(const char* doing, std::int64_t deadline, int busy, Attempt attempt) {
  for (std::uint32_t flags = kRecheck;; flags |= kAgain) {
    const int error = attempt();
    if (error != busy) return error;
    if (deadline <= now_ns()) return ETIMEDOUT;
    park({doing, deadline, flags});
  }
}

int lock_until(pthread_mutex_t* mutex, clockid_t clock, const timespec* time) {
  return try_until("pthread_mutex_timedlock", when(clock, time), EBUSY,
                   [&] { return VISUM_REAL(pthread_mutex_trylock)(mutex); });
}

int take_until(sem_t* semaphore, clockid_t clock, const timespec* time) {
  const int error = try_until("sem_timedwait", when(clock, time), EAGAIN,
                              [&] { return VISUM_REAL(sem_trywait)(semaphore) == 0 ? 0 : errno; });
  if (error == 0) return 0;
  errno = error;
  return -1;
}

bool is_valid(const timespec* time) {
  return time && time->tv_nsec >= 0 && time->tv_nsec < kSecond_ns;
}

// Reads glibc's own fields: whether processes share the condition variable, and the clock of its deadlines.
bool is_shared(const pthread_cond_t* condition) {
  return (condition->__data.__wrefs & 1) != 0;
}
clockid_t clock_of(const pthread_cond_t* condition) {
  return (condition->__data.__wrefs & 2) ? CLOCK_MONOTONIC : CLOCK_REALTIME;
}

std::uint64_t key_of(const pthread_cond_t* condition) {
  return reinterpret_cast<std::uintptr_t>(condition);
}

// Announces the wait before the mutex is free, so that no signal is lost.
int await_condition(const char* doing, pthread_cond_t* condition, pthread_mutex_t* mutex,
                    std::int64_t deadline) {
  auto& slot = mine();
  announce({doing, deadline, 0, key_of(condition)});
  if (const int error = pthread_mutex_unlock(mutex); error != 0) {
    slot.key = 0;
    return error;
  }
  park_announced();
  const bool granted = (slot.flags & kGranted) != 0;
  const int error = pthread_mutex_lock(mutex);
  if (error != 0) return error;
  return !granted && now_ns() >= deadline ? ETIMEDOUT : 0;
}

// The thread of this process that has waited longest; null where no thread waits.
Slot* longest_waiting(std::uint64_t key) {
  Slot* first = nullptr;
  for (auto& slot : shared()->slots) {
    if (slot.key != key || slot.pid != mine().pid || (slot.flags & kGranted) != 0) continue;
    if (!first || slot.ticket < first->ticket) first = &slot;
  }
  return first;
}

void grant(const pthread_cond_t* condition, bool all) {
  while (auto* slot = longest_waiting(key_of(condition))) {
    slot->flags |= kGranted;
    if (!all) return;
  }
}

int await_until(const char* doing, pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                const timespec* time) {
  if (!is_valid(time)) return EINVAL;
  return await_condition(doing, condition, mutex, when(clock, time));
}

}  // namespace

VISUM_EXPORT int pthread_mutex_lock(pthread_mutex_t* mutex) noexcept {
  if (!active()) return VISUM_REAL(pthread_mutex_lock)(mutex);
  const int error = VISUM_REAL(pthread_mutex_trylock)(mutex);
  if (error != EBUSY) return error;
  return blocked("pthread_mutex_lock", [&] { return VISUM_REAL(pthread_mutex_lock)(mutex); });
}

VISUM_EXPORT int pthread_mutex_timedlock(pthread_mutex_t* mutex, const timespec* time) noexcept {
  if (!active()) return VISUM_REAL(pthread_mutex_timedlock)(mutex, time);
  return lock_until(mutex, CLOCK_REALTIME, time);
}

VISUM_EXPORT int pthread_mutex_clocklock(pthread_mutex_t* mutex, clockid_t clock,
                                         const timespec* time) noexcept {
  if (!active()) return VISUM_REAL(pthread_mutex_clocklock)(mutex, clock, time);
  return lock_until(mutex, clock, time);
}

VISUM_EXPORT int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
  if (!active() || is_shared(condition)) return VISUM_REAL_CONDITION(pthread_cond_wait)(condition, mutex);
  return await_condition("pthread_cond_wait", condition, mutex, kNever);
}

VISUM_EXPORT int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex,
                                        const timespec* time) {
  if (!active() || is_shared(condition))
    return VISUM_REAL_CONDITION(pthread_cond_timedwait)(condition, mutex, time);
  return await_until("pthread_cond_timedwait", condition, mutex, clock_of(condition), time);
}

VISUM_EXPORT int pthread_cond_clockwait(pthread_cond_t* condition, pthread_mutex_t* mutex, clockid_t clock,
                                        const timespec* time) {
  if (!active() || is_shared(condition))
    return VISUM_REAL(pthread_cond_clockwait)(condition, mutex, clock, time);
  return await_until("pthread_cond_clockwait", condition, mutex, clock, time);
}

VISUM_EXPORT int pthread_cond_signal(pthread_cond_t* condition) noexcept {
  if (!active() || is_shared(condition)) return VISUM_REAL_CONDITION(pthread_cond_signal)(condition);
  grant(condition, false);
  return 0;
}

VISUM_EXPORT int pthread_cond_broadcast(pthread_cond_t* condition) noexcept {
  if (!active() || is_shared(condition)) return VISUM_REAL_CONDITION(pthread_cond_broadcast)(condition);
  grant(condition, true);
  return 0;
}

VISUM_EXPORT int sem_wait(sem_t* semaphore) {
  if (!active() || VISUM_REAL(sem_trywait)(semaphore) == 0)
    return active() ? 0 : VISUM_REAL(sem_wait)(semaphore);
  if (errno != EAGAIN) return -1;
  return blocked("sem_wait", [&] { return VISUM_REAL(sem_wait)(semaphore); });
}

VISUM_EXPORT int sem_timedwait(sem_t* semaphore, const timespec* time) {
  if (!active()) return VISUM_REAL(sem_timedwait)(semaphore, time);
  return take_until(semaphore, CLOCK_REALTIME, time);
}

VISUM_EXPORT int sem_clockwait(sem_t* semaphore, clockid_t clock, const timespec* time) {
  if (!active()) return VISUM_REAL(sem_clockwait)(semaphore, clock, time);
  return take_until(semaphore, clock, time);
}

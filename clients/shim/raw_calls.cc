// Calls of the kernel made by syscall(): libstdc++ waits for futures, semaphores and atomics this way, and
// some programs sleep, read a clock or start a process by it.
#include <errno.h>
#include <linux/futex.h>
#include <linux/sched.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <string.h>
#include <sys/epoll.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <atomic>

#include "clients/shim/clocks.h"
#include "clients/shim/processes.h"
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

template <typename T>
T* pointer(long word) {
  return reinterpret_cast<T*>(word);
}

// As the kernel answers: -1 and errno.
long as_the_kernel(int error) {
  return error == 0 ? 0 : refuse(error);
}

// clone(2), without a stack of the child's own: like fork().
long clone(const Call& call) {
  const bool is_fork = is_like_fork(call.words[0]) && call.words[1] == 0;
  if (!is_fork) return spawn_by([&] { return carry_out(call); });
  Call fork = call;
  fork.words[0] = as_fork(call.words[0]);
  return fork_by([&] { return carry_out(fork); });
}

// clone3(2): the same.
long clone3(const Call& call) {
  clone_args given{};
  const auto size = static_cast<std::size_t>(call.words[1]);
  if (size <= sizeof given) ::memcpy(&given, pointer<const void>(call.words[0]), size);
  const auto flags = static_cast<long>(given.flags);
  if (size > sizeof given || !is_like_fork(flags) || given.stack != 0)
    return spawn_by([&] { return carry_out(call); });
  given.flags = static_cast<std::uint64_t>(as_fork(flags));
  return fork_by([&] { return carry_out({call.number, {reinterpret_cast<long>(&given), call.words[1]}}); });
}

// Processes are started, replaced, awaited and ended as by the C library's functions.
long process_in_step(const Call& call) {
  const auto& word = call.words;
  switch (call.number) {
    case SYS_fork:
    case SYS_vfork:
      return ::fork();
    case SYS_clone:
      return clone(call);
    case SYS_clone3:
      return clone3(call);
    case SYS_execve:
      return ::execve(pointer<const char>(word[0]), pointer<char* const>(word[1]),
                      pointer<char* const>(word[2]));
    case SYS_execveat:
      return ::execveat(static_cast<int>(word[0]), pointer<const char>(word[1]),
                        pointer<char* const>(word[2]), pointer<char* const>(word[3]),
                        static_cast<int>(word[4]));
    case SYS_wait4:
      return ::wait4(static_cast<pid_t>(word[0]), pointer<int>(word[1]), static_cast<int>(word[2]),
                     pointer<rusage>(word[3]));
    case SYS_exit_group:
      ::_exit(static_cast<int>(word[0]));
    default:
      return carry_out(call);
  }
}

// Clocks, sleeps, and reads and waits of descriptors are those of the C library's functions, which this
// library has replaced.
long in_step(const Call& call) {
  const auto& word = call.words;
  switch (call.number) {
    case SYS_futex:
      return futex(call);
    case SYS_clock_gettime:
      return ::clock_gettime(static_cast<clockid_t>(word[0]), pointer<timespec>(word[1]));
    case SYS_gettimeofday:
      return ::gettimeofday(pointer<timeval>(word[0]), pointer<void>(word[1]));
    case SYS_nanosleep:
      return ::nanosleep(pointer<const timespec>(word[0]), pointer<timespec>(word[1]));
    case SYS_clock_nanosleep:
      return as_the_kernel(::clock_nanosleep(static_cast<clockid_t>(word[0]), static_cast<int>(word[1]),
                                             pointer<const timespec>(word[2]), pointer<timespec>(word[3])));
    case SYS_poll:
      return ::poll(pointer<pollfd>(word[0]), static_cast<nfds_t>(word[1]), static_cast<int>(word[2]));
    case SYS_ppoll:
      return ::ppoll(pointer<pollfd>(word[0]), static_cast<nfds_t>(word[1]), pointer<const timespec>(word[2]),
                     pointer<const sigset_t>(word[3]));
    case SYS_epoll_wait:
      return ::epoll_wait(static_cast<int>(word[0]), pointer<epoll_event>(word[1]), static_cast<int>(word[2]),
                          static_cast<int>(word[3]));
    case SYS_epoll_pwait:
      return ::epoll_pwait(static_cast<int>(word[0]), pointer<epoll_event>(word[1]),
                           static_cast<int>(word[2]), static_cast<int>(word[3]),
                           pointer<const sigset_t>(word[4]));
    case SYS_pselect6: {
      const auto* signals = pointer<const sigset_t* const>(word[5]);  // and, behind it, the set's size
      return ::pselect(static_cast<int>(word[0]), pointer<fd_set>(word[1]), pointer<fd_set>(word[2]),
                       pointer<fd_set>(word[3]), pointer<const timespec>(word[4]),
                       signals ? *signals : nullptr);
    }
    case SYS_select:
      return ::select(static_cast<int>(word[0]), pointer<fd_set>(word[1]), pointer<fd_set>(word[2]),
                      pointer<fd_set>(word[3]), pointer<timeval>(word[4]));
    case SYS_time:
      return ::time(pointer<time_t>(word[0]));
    case SYS_read:
      return ::read(static_cast<int>(word[0]), pointer<void>(word[1]), static_cast<std::size_t>(word[2]));
    case SYS_write:
      return ::write(static_cast<int>(word[0]), pointer<const void>(word[1]),
                     static_cast<std::size_t>(word[2]));
    case SYS_ioctl:
      return ::ioctl(static_cast<int>(word[0]), static_cast<unsigned long>(word[1]), word[2]);
    default:
      return process_in_step(call);
  }
}

}  // namespace

VISUM_EXPORT long syscall(long number, ...) noexcept {
  Call call{number, {}};
  va_list list;
  va_start(list, number);
  for (long& word : call.words) word = va_arg(list, long);
  va_end(list);
  return active() ? in_step(call) : carry_out(call);
}

#include "clients/shim/timers.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <iterator>

#include "clients/shim/clocks.h"
#include "clients/shim/real.h"
#include "clients/shim/turns.h"

namespace visum::shim {
namespace {

constexpr int kMostTimers = 64;
constexpr int kOwnDescriptors = 512;  // our copies lie above, out of the program's way

// The program's timerfd is an eventfd here, which counts as a timerfd does. The shim writes to its own copy
// of the descriptor: the program may have put something else in the original's place.
struct Timer {
  std::atomic<bool> used;
  int fd, copy;
  clockid_t clock;
  std::int64_t deadline_ns, interval_ns;  // kNever: not armed
};
Timer timers[kMostTimers];

Timer* timer_of(int fd) {
  for (auto& timer : timers)
    if (timer.used && timer.fd == fd) return &timer;
  return nullptr;
}

void fire(Timer& timer) {
  const auto now = now_ns();
  if (!timer.used || timer.deadline_ns > now) return;
  std::uint64_t count = 1;
  if (timer.interval_ns > 0)
    count += static_cast<std::uint64_t>((now - timer.deadline_ns) / timer.interval_ns);
  timer.deadline_ns = timer.interval_ns > 0
                          ? timer.deadline_ns + static_cast<std::int64_t>(count) * timer.interval_ns
                          : kNever;
  [[maybe_unused]] const auto written = VISUM_REAL(write)(timer.copy, &count, sizeof count);
}

void empty(const Timer& timer) {
  pollfd set{timer.copy, POLLIN, 0};
  std::uint64_t count = 0;
  if (VISUM_REAL(poll)(&set, 1, 0) > 0) [[maybe_unused]]
    const auto got = VISUM_REAL(read)(timer.copy, &count, sizeof count);
}

itimerspec setting_of(std::int64_t deadline_ns, std::int64_t interval_ns) {
  itimerspec setting{to_timespec(interval_ns), {}};
  if (deadline_ns != kNever)
    setting.it_value = to_timespec(std::max<std::int64_t>(1, deadline_ns - now_ns()));
  return setting;
}

// This process' entry; null where no alarm is set, or where the table is full.
Alarm* alarm_of(std::int32_t pid, bool make) {
  for (auto& alarm : shared()->alarms)
    if (alarm.pid == pid) return &alarm;
  for (auto& alarm : shared()->alarms) {
    std::int32_t none = 0;
    if (!make || !alarm.pid.compare_exchange_strong(none, pid)) continue;
    alarm.deadline_ns = kNever;
    return &alarm;
  }
  return nullptr;
}

timeval to_timeval(std::int64_t ns) {
  return {ns / kSecond_ns, ns % kSecond_ns / 1000};
}
std::int64_t ns_of(const timeval& time) {
  return time.tv_sec * kSecond_ns + time.tv_usec * 1000;
}

itimerval alarm_setting(const Alarm* alarm) {
  if (!alarm || alarm->deadline_ns == kNever) return {};
  return {to_timeval(alarm->interval_ns),
          to_timeval(std::max<std::int64_t>(1000, alarm->deadline_ns - now_ns()))};
}

}  // namespace

void fire_timers() {
  const int error = errno;
  for (auto& timer : timers) fire(timer);
  errno = error;
}

std::int64_t next_timer_ns() {
  auto next = kNever;
  for (const auto& timer : timers)
    if (timer.used) next = std::min(next, timer.deadline_ns);
  return next;
}

bool has_timers() {
  return std::any_of(std::begin(timers), std::end(timers),
                     [](const Timer& timer) { return timer.used.load(); });
}

void forget_timer(int fd) {
  auto* timer = timer_of(fd);
  if (!timer) return;
  VISUM_REAL(close)(timer->copy);
  timer->used = false;
}

void forget_all_timers() {
  for (auto& timer : timers) timer.used = false;
}

}  // namespace visum::shim

using namespace visum::shim;

// These timers stay the host's. The run is not in step with a program that makes one, unless it measures
// processor time.
VISUM_EXPORT int timer_create(clockid_t clock, sigevent* event, timer_t* timer) noexcept {
  std::int64_t base = 0;
  if (active() && base_of(clock, base)) shared()->host_timer_of = ::getpid();
  return VISUM_REAL(timer_create)(clock, event, timer);
}

VISUM_EXPORT int timerfd_create(clockid_t clock, int flags) noexcept {
  std::int64_t base = 0;
  if (!active() || !base_of(clock, base)) return VISUM_REAL(timerfd_create)(clock, flags);
  const int fd =
      ::eventfd(0, ((flags & TFD_NONBLOCK) ? EFD_NONBLOCK : 0) | ((flags & TFD_CLOEXEC) ? EFD_CLOEXEC : 0));
  if (fd < 0) return fd;
  for (auto& timer : timers) {
    if (timer.used) continue;
    timer.fd = fd;
    timer.copy = ::fcntl(fd, F_DUPFD_CLOEXEC, kOwnDescriptors);
    timer.clock = clock;
    timer.deadline_ns = kNever;
    timer.interval_ns = 0;
    timer.used = timer.copy >= 0;
    if (timer.used) return fd;
  }
  VISUM_REAL(close)(fd);
  errno = EMFILE;
  return -1;
}

VISUM_EXPORT int timerfd_settime(int fd, int flags, const itimerspec* setting, itimerspec* old) noexcept {
  auto* timer = active() ? timer_of(fd) : nullptr;
  if (!timer || !setting) return VISUM_REAL(timerfd_settime)(fd, flags, setting, old);
  if (old) *old = setting_of(timer->deadline_ns, timer->interval_ns);
  empty(*timer);
  const auto value = to_ns(setting->it_value);
  timer->interval_ns = to_ns(setting->it_interval);
  if (value == 0)
    timer->deadline_ns = kNever;
  else
    timer->deadline_ns =
        (flags & TFD_TIMER_ABSTIME) ? when(timer->clock, &setting->it_value) : after_ns(now_ns(), value);
  return 0;
}

VISUM_EXPORT int timerfd_gettime(int fd, itimerspec* setting) noexcept {
  const auto* timer = active() ? timer_of(fd) : nullptr;
  if (!timer || !setting) return VISUM_REAL(timerfd_gettime)(fd, setting);
  fire_timers();
  *setting = setting_of(timer->deadline_ns, timer->interval_ns);
  return 0;
}

VISUM_EXPORT int close(int fd) {
  if (active()) forget_timer(fd);
  return VISUM_REAL(close)(fd);
}

VISUM_EXPORT int setitimer(__itimer_which_t which, const itimerval* setting, itimerval* old) noexcept {
  if (!active() || which != ITIMER_REAL || !setting) return VISUM_REAL(setitimer)(which, setting, old);
  const auto value = ns_of(setting->it_value);
  auto* alarm = alarm_of(::getpid(), value > 0);
  if (old) *old = alarm_setting(alarm);
  if (!alarm && value > 0) {
    errno = ENOMEM;
    return -1;
  }
  if (!alarm) return 0;
  alarm->interval_ns = ns_of(setting->it_interval);
  alarm->deadline_ns = value > 0 ? after_ns(now_ns(), value) : kNever;
  return 0;
}

VISUM_EXPORT int getitimer(__itimer_which_t which, itimerval* setting) noexcept {
  if (!active() || which != ITIMER_REAL || !setting) return VISUM_REAL(getitimer)(which, setting);
  *setting = alarm_setting(alarm_of(::getpid(), false));
  return 0;
}

VISUM_EXPORT unsigned int alarm(unsigned int seconds) noexcept {
  if (!active()) return VISUM_REAL(alarm)(seconds);
  const itimerval setting{{0, 0}, {static_cast<time_t>(seconds), 0}};
  itimerval old{};
  setitimer(ITIMER_REAL, &setting, &old);
  return static_cast<unsigned int>(old.it_value.tv_sec + (old.it_value.tv_usec > 0 ? 1 : 0));
}

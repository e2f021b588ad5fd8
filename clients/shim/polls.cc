// poll, select and epoll, with and without signals.
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <sys/epoll.h>
#include <sys/select.h>

#include <span>

#include "clients/shim/clocks.h"
#include "clients/shim/fd_waits.h"
#include "clients/shim/real.h"

using namespace visum::shim;

namespace {

constexpr timespec kAtOnce{};

std::int64_t deadline_after_ms(int ms) {
  return ms < 0 ? kNever : after_ns(now_ns(), std::int64_t{ms} * 1'000'000);
}

std::int64_t deadline_after(const timespec* length) {
  return length ? after_ns(now_ns(), visum::shim::to_ns(*length)) : kNever;
}

// Counts a look that found nothing and did not wait.
int noted(const FdWait& wait, int found, bool at_once) {
  if (found == 0 && at_once) note_look(wait.doing, wait.on_bus);
  return found;
}

void add(int fd, FdWait& wait) {
  if (fd < 0) return;
  const auto what = descriptor(fd);
  wait.on_bus |= what.on_bus();
  wait.streams |= what.stream_bit();
  wait.on_session |= what.is_session;
}

int poll_until(const char* doing, pollfd* set, nfds_t count, std::int64_t deadline, const sigset_t* signals) {
  const auto look = [&] { return VISUM_REAL(ppoll)(set, count, &kAtOnce, signals); };
  if (const int found = count > 0 ? look_at_settled(look) : 0; found != 0) return found;
  FdWait wait{doing, deadline};
  for (const auto& one : std::span(set, count)) add(one.fd, wait);
  const bool at_once = deadline <= now_ns();
  const int found = wait_for(
      wait, look, [&](const timespec* length) { return VISUM_REAL(ppoll)(set, count, length, signals); });
  return noted(wait, found, at_once);
}

struct Sets {
  int count;
  fd_set *read, *write, *error;
};

void add_all(const Sets& sets, FdWait& wait) {
  for (int fd = 0; fd < sets.count; ++fd)
    for (const auto* set : {sets.read, sets.write, sets.error})
      if (set && FD_ISSET(fd, set)) add(fd, wait);
}

// select() changes its sets even where it finds nothing, so it gets copies.
int select_once(const Sets& sets, const timespec* length, const sigset_t* signals) {
  fd_set copies[3];
  fd_set* const originals[] = {sets.read, sets.write, sets.error};
  fd_set* given[3];
  for (int i = 0; i < 3; ++i) {
    if (originals[i]) copies[i] = *originals[i];
    given[i] = originals[i] ? &copies[i] : nullptr;
  }
  const int found = VISUM_REAL(pselect)(sets.count, given[0], given[1], given[2], length, signals);
  for (int i = 0; found > 0 && i < 3; ++i)
    if (originals[i]) *originals[i] = copies[i];
  return found;
}

int select_until(const char* doing, const Sets& sets, std::int64_t deadline, const sigset_t* signals) {
  const auto look = [&] { return select_once(sets, &kAtOnce, signals); };
  if (const int found = sets.count > 0 ? look_at_settled(look) : 0; found != 0) return found;
  const bool at_once = deadline <= now_ns();
  FdWait wait{doing, deadline};
  add_all(sets, wait);
  const int found =
      wait_for(wait, look, [&](const timespec* length) { return select_once(sets, length, signals); });
  for (auto* set : {sets.read, sets.write, sets.error})
    if (found == 0 && set) FD_ZERO(set);
  return noted(wait, found, at_once);
}

int epoll_until(const char* doing, int epoll, epoll_event* events, int most, std::int64_t deadline,
                const sigset_t* signals) {
  const auto look = [&] { return VISUM_REAL(epoll_pwait)(epoll, events, most, 0, signals); };
  if (const int found = look_at_settled(look); found != 0) return found;
  const bool at_once = deadline <= now_ns();
  const auto buses = watched_buses(epoll);
  const FdWait wait{doing, deadline, buses.any, false, buses.streams};
  const int found = wait_for(
      wait, look, [&](const timespec*) { return VISUM_REAL(epoll_pwait)(epoll, events, most, -1, signals); });
  return noted(wait, found, at_once);
}

}  // namespace

VISUM_EXPORT int poll(pollfd* set, nfds_t count, int ms) {
  if (!active()) return VISUM_REAL(poll)(set, count, ms);
  return poll_until("poll", set, count, deadline_after_ms(ms), nullptr);
}

VISUM_EXPORT int __poll_chk(pollfd* set, nfds_t count, int ms, std::size_t) {
  return poll(set, count, ms);
}

VISUM_EXPORT int ppoll(pollfd* set, nfds_t count, const timespec* length, const sigset_t* signals) {
  if (!active()) return VISUM_REAL(ppoll)(set, count, length, signals);
  return poll_until("ppoll", set, count, deadline_after(length), signals);
}

VISUM_EXPORT int __ppoll_chk(pollfd* set, nfds_t count, const timespec* length, const sigset_t* signals,
                             std::size_t) {
  return ppoll(set, count, length, signals);
}

VISUM_EXPORT int select(int count, fd_set* read, fd_set* write, fd_set* error, timeval* length) {
  if (!active()) return VISUM_REAL(select)(count, read, write, error, length);
  const auto before = now_ns();
  const auto span = length ? length->tv_sec * kSecond_ns + length->tv_usec * 1000 : 0;
  const auto deadline = length ? after_ns(before, span) : kNever;
  const int found = select_until("select", {count, read, write, error}, deadline, nullptr);
  const auto left = length ? std::max<std::int64_t>(0, span - (now_ns() - before)) : 0;
  if (length) *length = {left / kSecond_ns, left % kSecond_ns / 1000};
  return found;
}

VISUM_EXPORT int pselect(int count, fd_set* read, fd_set* write, fd_set* error, const timespec* length,
                         const sigset_t* signals) {
  if (!active()) return VISUM_REAL(pselect)(count, read, write, error, length, signals);
  return select_until("pselect", {count, read, write, error}, deadline_after(length), signals);
}

VISUM_EXPORT int epoll_wait(int epoll, epoll_event* events, int most, int ms) {
  if (!active()) return VISUM_REAL(epoll_wait)(epoll, events, most, ms);
  return epoll_until("epoll_wait", epoll, events, most, deadline_after_ms(ms), nullptr);
}

VISUM_EXPORT int epoll_pwait(int epoll, epoll_event* events, int most, int ms, const sigset_t* signals) {
  if (!active()) return VISUM_REAL(epoll_pwait)(epoll, events, most, ms, signals);
  return epoll_until("epoll_pwait", epoll, events, most, deadline_after_ms(ms), signals);
}

VISUM_EXPORT int epoll_pwait2(int epoll, epoll_event* events, int most, const timespec* length,
                              const sigset_t* signals) {
  if (!active()) return VISUM_REAL(epoll_pwait2)(epoll, events, most, length, signals);
  return epoll_until("epoll_pwait2", epoll, events, most, deadline_after(length), signals);
}

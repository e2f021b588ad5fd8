// read, recv, accept and their like: they wait as their descriptor, its flags and its options say.
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <sys/uio.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

#include "clients/shim/clocks.h"
#include "clients/shim/fd_waits.h"
#include "clients/shim/real.h"

namespace visum::shim {

int wait_readable(const char* doing, int fd, const Descriptor& what, std::int64_t deadline_ns) {
  pollfd set{fd, POLLIN, 0};
  return wait_for(
      {doing, deadline_ns, what.on_bus(), what.is_session, what.stream_bit()},
      [&] { return VISUM_REAL(poll)(&set, 1, 0); },
      [&](const timespec* length) { return VISUM_REAL(ppoll)(&set, 1, length, nullptr); });
}

}  // namespace visum::shim

using namespace visum::shim;

namespace {

constexpr std::int64_t kVtimeUnit_ns = 100'000'000;

bool is_nonblocking(int fd) {
  return (::fcntl(fd, F_GETFL) & O_NONBLOCK) != 0;
}

// A call that does not wait. It finds exactly what the server has sent by now.
template <typename Call>
ssize_t look(const char* doing, const Descriptor& from, Call call) {
  fire_timers();
  if (from.on_bus()) catch_up(from.stream_bit());
  const ssize_t got = call();
  if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) note_look(doing, from.on_bus());
  return got;
}

// SO_RCVTIMEO.
std::int64_t receive_deadline(int fd) {
  timeval length{};
  socklen_t size = sizeof length;
  if (::getsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &length, &size) != 0) return kNever;
  const auto ns = length.tv_sec * kSecond_ns + length.tv_usec * 1000;
  return ns > 0 ? after_ns(now_ns(), ns) : kNever;
}

// Waits where `call` would, then calls it.
template <typename Call>
ssize_t receive(const char* doing, int fd, bool at_once, Call call) {
  const auto from = descriptor(fd);
  if (!from.can_wait) return call();
  if (at_once || is_nonblocking(fd)) return look(doing, from, call);
  const int found = wait_readable(doing, fd, from, from.is_socket ? receive_deadline(fd) : kNever);
  if (found > 0) return call();
  if (found == 0) errno = EAGAIN;
  return -1;
}

template <typename Call>
ssize_t receive_counted(const char* doing, int fd, int flags, Call call) {
  const auto got = receive(doing, fd, (flags & MSG_DONTWAIT) != 0, call);
  if (got > 0 && !(flags & MSG_PEEK)) note_read(descriptor(fd), got);
  return got;
}

int available(int fd) {
  catch_up(0);  // a terminal
  bring_in(fd);
  return available_bytes(fd);
}

// A terminal's read waits for `least` bytes, each at most `pause_ns` after the one before; see termios(3).
struct TtyRules {
  int least = 1;
  std::int64_t pause_ns = kNever;
  bool from_first_byte = true;  // the pause counts from the first byte on, not from the call
};

TtyRules rules_of(int fd) {
  termios settings{};
  if (::tcgetattr(fd, &settings) != 0 || (settings.c_lflag & ICANON)) return {};
  TtyRules rules;
  rules.least = settings.c_cc[VMIN];
  if (settings.c_cc[VTIME] > 0) rules.pause_ns = settings.c_cc[VTIME] * kVtimeUnit_ns;
  if (rules.least == 0) rules = {1, rules.pause_ns == kNever ? 0 : rules.pause_ns, false};
  return rules;
}

// The number of bytes that a read of at most `most` gets; -1 after a signal.
int await_tty(int fd, const TtyRules& rules, int most) {
  int count = available(fd);
  auto deadline = rules.from_first_byte && count == 0 ? kNever : after_ns(now_ns(), rules.pause_ns);
  for (std::uint32_t flags = kRecheck | kOnBus;
       count >= 0 && count < std::min(rules.least, most) && now_ns() < deadline; flags |= kAgain) {
    if (!park({"read", deadline, flags})) return -1;
    const int before = std::exchange(count, available(fd));
    if (count != before) deadline = after_ns(now_ns(), rules.pause_ns);
  }
  return std::min(count, most);
}

ssize_t read_tty(int fd, void* to, std::size_t size) {
  const auto rules = rules_of(fd);
  const int most = static_cast<int>(std::min<std::size_t>(size, 4096));
  const int count = await_tty(fd, rules, most);
  if (count < 0) {
    errno = EINTR;
    return -1;
  }
  if (count == 0 && rules.pause_ns == 0) note_look("read", true);
  if (count == 0) return 0;
  note_progress();
  return VISUM_REAL(read)(fd, to, static_cast<std::size_t>(count));
}

// No read waits that can be filled, wherever it leads. Programs that read byte by byte ask most often.
bool can_fill(int fd, std::size_t size) {
  if (!is_settled() || !has_looked_little()) return false;
  const int error = errno;
  const int there = available_bytes(fd);
  errno = error;
  return there > 0 && static_cast<std::size_t>(there) >= size;
}

}  // namespace

VISUM_EXPORT ssize_t read(int fd, void* to, std::size_t size) {
  if (!active() || size == 0 || can_fill(fd, size)) return VISUM_REAL(read)(fd, to, size);
  if (descriptor(fd).is_tty && !is_nonblocking(fd)) return read_tty(fd, to, size);
  return receive_counted("read", fd, 0, [&] { return VISUM_REAL(read)(fd, to, size); });
}

VISUM_EXPORT ssize_t __read_chk(int fd, void* to, std::size_t size, std::size_t) {
  return read(fd, to, size);
}

VISUM_EXPORT ssize_t readv(int fd, const iovec* to, int count) {
  if (!active()) return VISUM_REAL(readv)(fd, to, count);
  return receive_counted("readv", fd, 0, [&] { return VISUM_REAL(readv)(fd, to, count); });
}

VISUM_EXPORT ssize_t recv(int fd, void* to, std::size_t size, int flags) {
  if (!active()) return VISUM_REAL(recv)(fd, to, size, flags);
  return receive_counted("recv", fd, flags, [&] { return VISUM_REAL(recv)(fd, to, size, flags); });
}

VISUM_EXPORT ssize_t __recv_chk(int fd, void* to, std::size_t size, std::size_t, int flags) {
  return recv(fd, to, size, flags);
}

VISUM_EXPORT ssize_t recvfrom(int fd, void* to, std::size_t size, int flags, sockaddr* from,
                              socklen_t* length) {
  if (!active()) return VISUM_REAL(recvfrom)(fd, to, size, flags, from, length);
  return receive_counted("recvfrom", fd, flags,
                         [&] { return VISUM_REAL(recvfrom)(fd, to, size, flags, from, length); });
}

VISUM_EXPORT ssize_t __recvfrom_chk(int fd, void* to, std::size_t size, std::size_t, int flags,
                                    sockaddr* from, socklen_t* length) {
  return recvfrom(fd, to, size, flags, from, length);
}

VISUM_EXPORT ssize_t recvmsg(int fd, msghdr* to, int flags) {
  if (!active()) return VISUM_REAL(recvmsg)(fd, to, flags);
  return receive_counted("recvmsg", fd, flags, [&] { return VISUM_REAL(recvmsg)(fd, to, flags); });
}

VISUM_EXPORT int accept4(int fd, sockaddr* from, socklen_t* length, int flags) {
  if (!active()) return VISUM_REAL(accept4)(fd, from, length, flags);
  return static_cast<int>(
      receive("accept", fd, false, [&] { return VISUM_REAL(accept4)(fd, from, length, flags); }));
}

VISUM_EXPORT int accept(int fd, sockaddr* from, socklen_t* length) {
  if (!active()) return VISUM_REAL(accept)(fd, from, length);
  return accept4(fd, from, length, 0);
}

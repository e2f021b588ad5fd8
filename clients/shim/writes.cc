// Writes to the server are counted. Output to a bus' terminal cannot be discarded any more.
#include <stdarg.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <termios.h>
#include <unistd.h>

#include "clients/shim/descriptors.h"
#include "clients/shim/real.h"
#include "clients/shim/turns.h"

using namespace visum::shim;

namespace {

template <typename Call>
ssize_t counted(int fd, Call call) {
  if (!active()) return call();
  const auto to = descriptor(fd);
  const ssize_t sent = call();
  note_written(to, sent);
  return sent;
}

// A serial port has sent the bytes of a write when it returns, as far as a program can tell; in a pseudo
// terminal they may still lie. So there is never any output left to discard. Input is discarded once all of
// it is there.
int flush(int fd, int queue) {
  if (active() && descriptor(fd).is_tty) {
    if (queue == TCOFLUSH) return 0;
    catch_up(0);
    bring_in(fd);
    queue = TCIFLUSH;
  }
  return static_cast<int>(VISUM_REAL(syscall)(SYS_ioctl, fd, TCFLSH, queue));
}

}  // namespace

VISUM_EXPORT ssize_t write(int fd, const void* from, std::size_t size) {
  return counted(fd, [&] { return VISUM_REAL(write)(fd, from, size); });
}

VISUM_EXPORT ssize_t writev(int fd, const iovec* from, int count) {
  return counted(fd, [&] { return VISUM_REAL(writev)(fd, from, count); });
}

VISUM_EXPORT ssize_t send(int fd, const void* from, std::size_t size, int flags) {
  return counted(fd, [&] { return VISUM_REAL(send)(fd, from, size, flags); });
}

VISUM_EXPORT ssize_t sendto(int fd, const void* from, std::size_t size, int flags, const sockaddr* to,
                            socklen_t length) {
  return counted(fd, [&] { return VISUM_REAL(sendto)(fd, from, size, flags, to, length); });
}

VISUM_EXPORT ssize_t sendmsg(int fd, const msghdr* from, int flags) {
  return counted(fd, [&] { return VISUM_REAL(sendmsg)(fd, from, flags); });
}

VISUM_EXPORT int connect(int fd, const sockaddr* to, socklen_t length) {
  const int result = VISUM_REAL(connect)(fd, to, length);
  if (active()) note_connected(fd);
  return result;
}

VISUM_EXPORT int tcflush(int fd, int queue) noexcept {
  return flush(fd, queue);
}

VISUM_EXPORT int ioctl(int fd, unsigned long request, ...) noexcept {
  va_list list;
  va_start(list, request);
  void* argument = va_arg(list, void*);
  va_end(list);
  if (request == TCFLSH) return flush(fd, static_cast<int>(reinterpret_cast<long>(argument)));
  const auto what = active() && request == FIONREAD ? descriptor(fd) : Descriptor{};
  const bool looks = what.on_bus();
  if (looks) {
    catch_up(what.stream_bit());
    bring_in(fd);
  }
  const int result = static_cast<int>(VISUM_REAL(syscall)(SYS_ioctl, fd, request, argument));
  if (looks && result == 0 && *static_cast<int*>(argument) == 0) note_look("ioctl", true);
  return result;
}

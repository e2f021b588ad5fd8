#include "clients/shim/descriptors.h"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <span>
#include <utility>

#include "clients/shim/real.h"
#include "clients/shim/turns.h"

namespace visum::shim {
namespace {

constexpr int kMostPauses = 5000;  // of 1 ms: what the server has written on loopback comes
// A program that leaves so much unread, and to which nothing more comes for so long, has a full socket: the
// server's bytes wait at its end until the program reads.
constexpr int kFullBytes = 8192, kFullPauses = 100;

std::atomic<int> descriptor_of_stream[kMostStreams];  // in this process; + 1

using AskAddress = int (*)(int, sockaddr*, socklen_t*);

std::uint32_t port_of(int fd, AskAddress ask) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  const bool known =
      ask(fd, reinterpret_cast<sockaddr*>(&address), &size) == 0 && address.sin_family == AF_INET;
  return known ? ntohs(address.sin_port) : 0;
}

// Our end's port where the other end is a bus; else 0.
std::uint32_t port_to_bus(int fd) {
  const auto ports = std::span(shared()->ports, shared()->port_count);
  const bool leads_there = std::ranges::find(ports, port_of(fd, ::getpeername)) != ports.end();
  return leads_there ? port_of(fd, ::getsockname) : 0;
}

Stream* stream_of(std::uint32_t port) {
  if (port == 0) return nullptr;
  const auto streams = std::span(shared()->streams);
  const auto found =
      std::ranges::find_if(streams, [port](const auto& stream) { return stream.port == port; });
  return found == streams.end() ? nullptr : &*found;
}

Stream* take_free_stream() {
  for (auto& stream : shared()->streams) {
    std::uint32_t none = 0;
    if (stream.port.compare_exchange_strong(none, UINT32_MAX)) return &stream;
  }
  return nullptr;
}

// Asks the kernel which of these connections to a bus are still open: another process may have closed one.
void find_open(std::span<const Stream> streams, std::span<bool> open) {
  std::FILE* file = std::fopen("/proc/self/net/tcp", "re");  // proc(5)
  if (!file) {
    std::ranges::fill(open, true);
    return;
  }
  const auto buses = std::span(shared()->ports, shared()->port_count);
  char line[256];
  while (std::fgets(line, sizeof line, file)) {
    unsigned own = 0, other = 0, state = 0;
    if (std::sscanf(line, "%*d: %*x:%x %*x:%x %x", &own, &other, &state) != 3 || state == TCP_TIME_WAIT)
      continue;
    if (std::ranges::find(buses, other) == buses.end()) continue;
    for (std::size_t i = 0; i < streams.size(); ++i) open[i] = open[i] || streams[i].port == own;
  }
  std::fclose(file);
}

// A closed connection's place goes to a later one.
Stream* free_stream() {
  if (auto* stream = take_free_stream()) return stream;
  bool open[kMostStreams] = {};
  find_open(shared()->streams, open);
  for (std::size_t i = 0; i < kMostStreams; ++i) {
    auto port = shared()->streams[i].port.load();
    if (!open[i] && port <= UINT16_MAX) shared()->streams[i].port.compare_exchange_strong(port, 0);
  }
  return take_free_stream();
}

bool has_ended(int fd) {
  pollfd set{fd, POLLRDHUP, 0};
  return VISUM_REAL(poll)(&set, 1, 0) > 0 && (set.revents & (POLLRDHUP | POLLHUP | POLLERR | POLLNVAL)) != 0;
}

// Until all that the server has sent on this connection can be read. The kernel may still carry it over.
void await_said(int fd, Stream& stream) {
  const auto unread = stream.heard + 1;
  if (stream.full_at == unread) return;
  int before = 0, still = 0;
  for (int i = 0; i < kMostPauses; ++i) {
    const int there = available_bytes(fd);
    if (there < 0) return;
    if (stream.heard + static_cast<std::uint64_t>(there) >= stream.said || has_ended(fd)) return;
    if (i <= 100) continue;
    still = there == std::exchange(before, there) ? still + 1 : 0;
    if (there >= kFullBytes && still >= kFullPauses) {
      stream.full_at = unread;
      return;
    }
    VISUM_REAL(poll)(nullptr, 0, 1);
  }
}

}  // namespace

Descriptor descriptor(int fd) {
  Descriptor found;
  struct stat status;
  if (::fstat(fd, &status) != 0) return found;
  found.can_wait = !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
  found.is_socket = S_ISSOCK(status.st_mode);
  const auto ttys = std::span(shared()->ttys, shared()->tty_count);
  found.is_tty = S_ISCHR(status.st_mode) && std::ranges::find(ttys, status.st_rdev) != ttys.end();
  if (found.is_socket && shared()->port_count > 0) found.stream = stream_of(port_to_bus(fd));
  found.is_session = found.is_socket && port_of(fd, ::getpeername) == shared()->session_port;
  return found;
}

int available_bytes(int fd) {
  int count = 0;
  return VISUM_REAL(syscall)(SYS_ioctl, fd, FIONREAD, &count) == 0 ? count : -1;
}

void bring_in(int fd) {
  const int error = errno;
  pollfd set{fd, POLLIN, 0};
  VISUM_REAL(poll)(&set, 1, 0);
  errno = error;
}

std::uint64_t Descriptor::stream_bit() const {
  static_assert(kMostStreams <= 64);
  return stream ? std::uint64_t{1} << (stream - shared()->streams) : 0;
}

void catch_up(std::uint64_t streams) {
  const int error = errno;
  if (shared()->dirty) park({"settle", kNever, kSettle});
  for (std::size_t i = 0; i < kMostStreams; ++i) {
    if ((streams >> i & 1) == 0) continue;
    const int fd = descriptor_of_stream[i] - 1;
    auto& stream = shared()->streams[i];
    if (fd >= 0 && descriptor(fd).stream == &stream) await_said(fd, stream);
  }
  errno = error;
}

bool is_settled() {
  return shared()->port_count == 0 && shared()->dirty == 0;
}

void note_connected(int fd) {
  const int error = errno;
  const auto port = port_to_bus(fd);
  auto* stream = stream_of(port);
  if (!stream && port != 0) stream = free_stream();
  if (stream) {
    stream->written = stream->heard = stream->said = stream->full_at = 0;
    descriptor_of_stream[stream - shared()->streams] = fd + 1;
    stream->port = port;
  }
  errno = error;
}

void note_written(const Descriptor& to, std::int64_t count) {
  if (count <= 0) return;
  if (to.stream) to.stream->written += static_cast<std::uint64_t>(count);
  if (to.on_bus()) {
    shared()->dirty = 1;
    note_progress();
  }
  if (to.on_bus() || to.is_session) note_request();
}

void note_read(const Descriptor& from, std::int64_t count) {
  if (count > 0 && from.on_bus()) note_progress();
  if (count > 0 && from.stream) from.stream->heard += static_cast<std::uint64_t>(count);
}

WatchedBuses watched_buses(int epoll) {
  const int error = errno;
  char line[256];
  std::snprintf(line, sizeof line, "/proc/self/fdinfo/%d", epoll);
  std::FILE* file = std::fopen(line, "re");  // proc(5)
  WatchedBuses found{file == nullptr, file ? 0 : ~std::uint64_t{0}};
  while (file && std::fgets(line, sizeof line, file)) {
    int fd = -1;
    if (std::sscanf(line, "tfd: %d", &fd) != 1) continue;
    const auto what = descriptor(fd);
    found.any |= what.on_bus();
    found.streams |= what.stream_bit();
  }
  if (file) std::fclose(file);
  errno = error;
  return found;
}

}  // namespace visum::shim

#include "server/gateway/stop_door.h"

#include <netdb.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <new>
#include <stdexcept>
#include <utility>

namespace visum::gateway {
namespace {

constexpr int kLookMs = 2;           // how often the latch is looked at while an order waits
constexpr std::size_t kAtOnce = 64;  // datagrams that are handled before the latch is looked at again
constexpr int kRoom = 1 << 20;       // bytes of datagrams that wait, where the system allows so many

int bound_socket(const std::string& address, std::uint16_t port) {
  const auto place = address + ":" + std::to_string(port);
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const auto* host = address == "localhost" ? "127.0.0.1" : address.c_str();
  if (const int failure = ::getaddrinfo(host, std::to_string(port).c_str(), &hints, &found); failure != 0)
    throw std::runtime_error(place + ": " + ::gai_strerror(failure));
  const int fd = ::socket(found->ai_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  ::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &kRoom, sizeof kRoom);
  const int bound = fd < 0 ? -1 : ::bind(fd, found->ai_addr, found->ai_addrlen);
  const int error = errno;
  ::freeaddrinfo(found);
  if (bound == 0) return fd;
  if (fd >= 0) ::close(fd);
  throw std::runtime_error("UDP " + place + ": " + std::strerror(error));
}

// Drops work for which there is no memory. It is then like a datagram that is lost: its sender asks again.
template <typename Work>
void if_memory_suffices(Work work) try {
  work();
} catch (const std::bad_alloc&) {
}

}  // namespace

StopDoor::StopDoor(const std::string& address, std::uint16_t port, StopOrders orders)
    : orders_(std::move(orders)),
      socket_(bound_socket(address, port)),
      end_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  thread_ = std::thread([this] { run(); });
}

StopDoor::~StopDoor() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(end_, &one, sizeof one);
  thread_.join();
  ::close(end_);
  ::close(socket_);
}

void StopDoor::set_parts(std::vector<std::string> parts) {
  const std::lock_guard lock(mutex_);
  parts_ = std::move(parts);
}

void StopDoor::run() {
  std::array<pollfd, 2> polled{{{socket_, POLLIN, 0}, {end_, POLLIN, 0}}};
  while (!(polled[1].revents & POLLIN)) {
    ::poll(polled.data(), polled.size(), orders_.waits() ? kLookMs : -1);
    if (polled[0].revents & POLLIN) serve_some();
    if_memory_suffices([this] {
      for (const auto& [peer, answer] : orders_.acted(StopOrders::Clock::now())) send(peer, answer);
    });
  }
}

// Takes what is there in one call: whoever floods this port pays more for a datagram than we do.
void StopDoor::serve_some() {
  std::array<std::array<std::byte, protocol::kStopOrderBytes + 1>, kAtOnce> buffers;
  std::array<sockaddr_storage, kAtOnce> peers;
  std::array<iovec, kAtOnce> pieces;
  std::array<mmsghdr, kAtOnce> datagrams{};
  for (std::size_t i = 0; i < kAtOnce; ++i) {
    pieces[i] = {buffers[i].data(), buffers[i].size()};
    datagrams[i].msg_hdr.msg_name = &peers[i];
    datagrams[i].msg_hdr.msg_namelen = sizeof peers[i];
    datagrams[i].msg_hdr.msg_iov = &pieces[i];
    datagrams[i].msg_hdr.msg_iovlen = 1;
  }
  const int count = ::recvmmsg(socket_, datagrams.data(), kAtOnce, MSG_DONTWAIT, nullptr);
  {
    const std::lock_guard lock(mutex_);
    if (auto parts = std::exchange(parts_, {})) orders_.set_parts(std::move(*parts));
  }
  for (std::size_t i = 0; count > 0 && i < static_cast<std::size_t>(count); ++i) {
    if_memory_suffices([&] {
      const std::string peer(reinterpret_cast<const char*>(&peers[i]), datagrams[i].msg_hdr.msg_namelen);
      const auto answer =
          orders_.answer(std::span(buffers[i]).first(datagrams[i].msg_len), peer, StopOrders::Clock::now());
      if (answer) send(peer, *answer);
    });
  }
}

// An answer that does not leave is like one that is lost: the client asks again.
void StopDoor::send(const std::string& peer, const protocol::StopDatagram& datagram) const {
  const auto bytes = protocol::encode(datagram);
  ::sendto(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(peer.data()),
           static_cast<socklen_t>(peer.size()));
}

}  // namespace visum::gateway

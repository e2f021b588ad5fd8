#include "clients/bridges/common/peer_loop.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

#include "clients/visum/common/exit_code.h"

namespace visum::bridge {
namespace {

constexpr int kPortsToTry = 100;
constexpr std::size_t kReadBytes = 64u << 10;

struct Address {
  sockaddr_storage storage{};
  socklen_t size = 0;
};

Address resolve(const std::string& host, int port) {
  addrinfo hints{}, *found = nullptr;
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  if (::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found) != 0 || found == nullptr) {
    throw cli::ExitError(cli::kUsage, "--listen: '" + host + "' is no address; give numbers, as 127.0.0.1");
  }
  Address address;
  address.size = found->ai_addrlen;
  std::memcpy(&address.storage, found->ai_addr, found->ai_addrlen);
  ::freeaddrinfo(found);
  return address;
}

// Returns the listening socket, or -1 with errno.
int listen_on(const Address& address) {
  const int handle = ::socket(address.storage.ss_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (handle < 0) return -1;
  const int on = 1;
  ::setsockopt(handle, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (::bind(handle, reinterpret_cast<const sockaddr*>(&address.storage), address.size) == 0 &&
      ::listen(handle, 16) == 0) {
    return handle;
  }
  const int reason = errno;
  ::close(handle);
  errno = reason;
  return -1;
}

std::uint16_t port_of(int handle) {
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  ::getsockname(handle, reinterpret_cast<sockaddr*>(&storage), &size);
  return ntohs(storage.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6&>(storage).sin6_port
                                             : reinterpret_cast<sockaddr_in&>(storage).sin_port);
}

std::string text_of(const sockaddr_storage& storage) {
  std::array<char, 64> text{};
  const void* bytes =
      storage.ss_family == AF_INET6
          ? static_cast<const void*>(&reinterpret_cast<const sockaddr_in6&>(storage).sin6_addr)
          : static_cast<const void*>(&reinterpret_cast<const sockaddr_in&>(storage).sin_addr);
  ::inet_ntop(storage.ss_family, bytes, text.data(), text.size());
  return text.data();
}

}  // namespace

Door::Door(const std::string& address, int asked_port, std::uint16_t usual) {
  const int first = asked_port >= 0 ? asked_port : usual;
  const int last = asked_port >= 0 ? asked_port : usual + kPortsToTry;
  for (int port = first; port <= last && handle_ < 0; ++port) handle_ = listen_on(resolve(address, port));
  if (handle_ < 0) {
    const std::string where =
        first == last ? "port " + std::to_string(first)
                      : "any of the ports " + std::to_string(first) + " to " + std::to_string(last);
    throw cli::ExitError(cli::kUsage,
                         "cannot listen on " + address + ", " + where + ": " + std::strerror(errno));
  }
  port_ = port_of(handle_);
}

Door::~Door() {
  ::close(handle_);
}

struct PeerLoop::Peer {
  Peer(int socket, std::string where, std::unique_ptr<PeerSession> its_session)
      : handle(socket), address(std::move(where)), session(std::move(its_session)) {}
  ~Peer() { ::close(handle); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  int handle;
  std::string address;
  std::unique_ptr<PeerSession> session;
  const Clock::time_point since = Clock::now();
  Clock::time_point took = since;  // when it last took bytes, or had none to take
  bool spoke = false;
  std::string ended;
};

PeerLoop::PeerLoop(Door& door, MakeSession make_session, PeerLimits limits)
    : door_(door), make_session_(std::move(make_session)), limits_(limits) {}
PeerLoop::~PeerLoop() = default;

void PeerLoop::wait(std::chrono::milliseconds longest) {
  std::vector<pollfd> sockets{{door_.handle(), POLLIN, 0}};
  for (const auto& peer : peers_) {
    const bool waits = !peer->session->output().empty();
    sockets.push_back({peer->handle, static_cast<short>(waits ? POLLIN | POLLOUT : POLLIN), 0});
  }
  if (::poll(sockets.data(), sockets.size(), static_cast<int>(longest.count())) <= 0) return;
  for (std::size_t i = 0; i < peers_.size(); ++i) {
    if ((sockets[i + 1].revents & (POLLIN | POLLHUP | POLLERR)) != 0) hear(*peers_[i]);
  }
  if ((sockets[0].revents & POLLIN) != 0) accept_one();
}

void PeerLoop::accept_one() {
  sockaddr_storage storage{};
  socklen_t size = sizeof storage;
  const int handle =
      ::accept4(door_.handle(), reinterpret_cast<sockaddr*>(&storage), &size, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (handle < 0) return;
  if (peers_.size() >= limits_.peers) {
    spdlog::warn("{}: closed, {} peers are connected already", text_of(storage), limits_.peers);
    ::close(handle);
    return;
  }
  const int on = 1;
  ::setsockopt(handle, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  const std::string address = text_of(storage);
  peers_.push_back(std::make_unique<Peer>(handle, address, make_session_(address)));
}

void PeerLoop::hear(Peer& peer) {
  std::array<std::byte, kReadBytes> buffer;
  const ssize_t size = ::recv(peer.handle, buffer.data(), buffer.size(), 0);
  if (size > 0) {
    peer.spoke = true;
    peer.session->receive(std::span(buffer).first(static_cast<std::size_t>(size)));
  } else if (size == 0) {
    peer.ended = "it closed the connection";
  } else if (errno != EAGAIN && errno != EINTR) {
    peer.ended = std::strerror(errno);
  }
}

void PeerLoop::speak(Peer& peer, Clock::time_point now) {
  std::string& output = peer.session->output();
  if (output.size() < limits_.slow_bytes) peer.session->send_due(now);
  if (output.empty()) {
    peer.took = now;
    return;
  }
  const ssize_t sent = ::send(peer.handle, output.data(), output.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent > 0) {
    output.erase(0, static_cast<std::size_t>(sent));
    peer.took = now;
  } else if (sent < 0 && errno != EAGAIN && errno != EINTR) {
    peer.ended = std::strerror(errno);
  }
  if (output.size() > limits_.most_bytes) peer.ended = "it takes its data too slowly";
  if (now - peer.took > limits_.stall) peer.ended = "it takes no data";
}

void PeerLoop::send(Clock::time_point now) {
  for (const auto& peer : peers_) {
    speak(*peer, now);
    if (peer->ended.empty()) peer->ended = peer->session->ended();
    if (!peer->spoke && now - peer->since > limits_.first_bytes) peer->ended = "it says nothing";
  }
  drop_ended();
}

void PeerLoop::drop_ended() {
  std::erase_if(peers_, [](const auto& peer) {
    if (!peer->ended.empty()) spdlog::info("{}: closed: {}", peer->address, peer->ended);
    return !peer->ended.empty();
  });
}

std::chrono::milliseconds PeerLoop::follows_every() const {
  auto every = PeerSession::kNever;
  for (const auto& peer : peers_) every = std::min(every, peer->session->follows_every());
  return every;
}

}  // namespace visum::bridge

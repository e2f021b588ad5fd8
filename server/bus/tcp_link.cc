// A TCP port that works as a serial device server, for RS-232 and for slcan, with several clients at once.
// Only on loopback, since a bus knows no passwords.
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <stdexcept>

#include "server/bus/bus_link.h"

namespace visum::bus {
namespace {

constexpr int kBacklog = 16;

std::uint16_t port_number(const std::string& text) {
  std::uint16_t port = 0;
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, port);
  if (error != std::errc() || stopped != end)
    throw std::runtime_error("'" + text + "' is no TCP port: a number from 0 (any free one) to 65535");
  return port;
}

class TcpLink : public BusLink {
 public:
  explicit TcpLink(std::uint16_t port)
      : fd_(::socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    const int on = 1;
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    socklen_t size = sizeof address;
    auto* any = reinterpret_cast<sockaddr*>(&address);
    const bool listens = fd_ >= 0 && ::setsockopt(fd_, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on) == 0 &&
                         ::bind(fd_, any, sizeof address) == 0 && ::listen(fd_, kBacklog) == 0 &&
                         ::getsockname(fd_, any, &size) == 0;
    if (!listens) {
      const std::string why = std::strerror(errno);
      if (fd_ >= 0) ::close(fd_);
      throw std::runtime_error("cannot listen on 127.0.0.1:" + std::to_string(port) + ": " + why);
    }
    port_ = ntohs(address.sin_port);
  }
  ~TcpLink() override { ::close(fd_); }

  std::string name() const override { return "tcp:" + std::to_string(port_); }
  int listener() const override { return fd_; }
  std::unique_ptr<Channel> accept() override {
    sockaddr_in peer{};
    socklen_t size = sizeof peer;
    const int fd = ::accept4(fd_, reinterpret_cast<sockaddr*>(&peer), &size, SOCK_NONBLOCK | SOCK_CLOEXEC);
    short_ = fd < 0 && (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM);
    if (fd < 0) return nullptr;
    const int on = 1;
    ::setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    return std::make_unique<Channel>(fd, Speech::kUndecided, Channel::Reads::kBytes, ntohs(peer.sin_port));
  }
  bool is_short() const override { return short_; }

 private:
  int fd_;
  bool short_ = false;
  std::uint16_t port_ = 0;
};

}  // namespace

std::unique_ptr<BusLink> open_tcp(const std::string& port) {
  return std::make_unique<TcpLink>(port_number(port));
}

}  // namespace visum::bus

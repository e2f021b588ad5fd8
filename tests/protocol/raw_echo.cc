#include "tests/protocol/raw_echo.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <span>
#include <system_error>

#include "tests/protocol/checked.h"

namespace visum::testing {
namespace {

sockaddr_in loopback(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(port);
  return address;
}

void no_delay(int socket) {
  const int on = 1;
  checked(::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on), "TCP_NODELAY");
}

// Returns false at the end of the stream.
bool receive_all(int socket, std::span<std::byte> bytes) {
  const ssize_t received = ::recv(socket, bytes.data(), bytes.size(), MSG_WAITALL);
  return received == static_cast<ssize_t>(bytes.size());
}

void send_all(int socket, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    bytes = bytes.subspan(static_cast<std::size_t>(checked(static_cast<int>(sent), "send")));
  }
}

}  // namespace

RawEchoServer::RawEchoServer(std::size_t request_bytes, std::size_t reply_bytes)
    : request_bytes_(request_bytes), reply_bytes_(reply_bytes) {
  listener_ = checked(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), "socket");
  sockaddr_in address = loopback(0);
  checked(::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address), "bind");
  checked(::listen(listener_, 1), "listen");
  socklen_t size = sizeof address;
  checked(::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size), "getsockname");
  port_ = ntohs(address.sin_port);
  thread_ = std::thread([this] { serve(); });
}

RawEchoServer::~RawEchoServer() {
  ::shutdown(listener_, SHUT_RDWR);  // wakes an accept() that no client came for
  thread_.join();
  ::close(listener_);
}

void RawEchoServer::serve() {
  const int client = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC);
  if (client < 0) return;
  no_delay(client);
  std::vector<std::byte> request(request_bytes_), reply(reply_bytes_);
  while (receive_all(client, request)) send_all(client, reply);
  ::close(client);
}

RawEchoClient::RawEchoClient(std::uint16_t port, std::size_t request_bytes, std::size_t reply_bytes)
    : socket_(checked(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), "socket")),
      request_(request_bytes),
      reply_(reply_bytes) {
  const sockaddr_in address = loopback(port);
  checked(::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address), "connect");
  no_delay(socket_);
}

RawEchoClient::~RawEchoClient() {
  ::close(socket_);
}

void RawEchoClient::round_trip() {
  send_all(socket_, request_);
  if (!receive_all(socket_, reply_)) throw std::system_error(ECONNRESET, std::generic_category(), "recv");
}

}  // namespace visum::testing

#include "tests/protocol/raw_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>

#include "tests/protocol/checked.h"

namespace visum::testing {
namespace {

void connect_to(int fd, const std::string& address, std::uint16_t port) {
  sockaddr_in v4{AF_INET, htons(port), {}, {}};
  sockaddr_in6 v6{AF_INET6, htons(port), 0, {}, 0};
  if (::inet_pton(AF_INET, address.c_str(), &v4.sin_addr) == 1)
    checked(::connect(fd, reinterpret_cast<sockaddr*>(&v4), sizeof v4), "connect");
  else if (::inet_pton(AF_INET6, address.c_str(), &v6.sin6_addr) == 1)
    checked(::connect(fd, reinterpret_cast<sockaddr*>(&v6), sizeof v6), "connect");
  else
    throw std::invalid_argument(address);
}

void bind_to(int fd, const std::string& address) {
  sockaddr_in v4{AF_INET, 0, {}, {}};
  if (::inet_pton(AF_INET, address.c_str(), &v4.sin_addr) != 1) throw std::invalid_argument(address);
  checked(::bind(fd, reinterpret_cast<sockaddr*>(&v4), sizeof v4), "bind");
}

}  // namespace

RawClient::RawClient(std::uint16_t port, const Options& options) {
  const int family = options.address.find(':') == std::string::npos ? AF_INET : AF_INET6;
  fd_ = checked(::socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0), "socket");
  if (options.receive_buffer > 0)
    checked(::setsockopt(fd_, SOL_SOCKET, SO_RCVBUF, &options.receive_buffer, sizeof options.receive_buffer),
            "SO_RCVBUF");
  if (!options.from.empty()) bind_to(fd_, options.from);
  connect_to(fd_, options.address, port);
}

RawClient::~RawClient() {
  close();
}

void RawClient::close() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

std::size_t RawClient::send(std::span<const std::byte> bytes) {
  const ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  return sent > 0 ? static_cast<std::size_t>(sent) : 0;
}

void RawClient::send(std::uint64_t id, const protocol::Request& request) {
  const auto frame = frame_of(id, request);
  if (send(frame) != frame.size()) throw std::runtime_error("the frame did not go out whole");
}

void RawClient::send_hello(protocol::Role role, const std::string& name) {
  send(1, protocol::Hello{1, protocol::kProtocolVersion, name, role, {}});
}

void RawClient::read() {
  std::array<std::byte, 65536> chunk;
  while (!end_seen_) {
    const ssize_t received = ::recv(fd_, chunk.data(), chunk.size(), MSG_DONTWAIT);
    if (received < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
    if (received <= 0) end_seen_ = true;
    if (received > 0) bytes_.insert(bytes_.end(), chunk.begin(), chunk.begin() + received);
  }
}

std::optional<protocol::ReplyFrame> RawClient::reply() {
  read();
  if (bytes_.size() < protocol::kHeaderBytes) return std::nullopt;
  const std::size_t length = protocol::frame_length(std::span<const std::byte, 4>(bytes_.data(), 4));
  if (bytes_.size() < protocol::kHeaderBytes + length) return std::nullopt;
  std::string why;
  auto frame = protocol::decode_reply({bytes_.data() + protocol::kHeaderBytes, length}, why);
  if (!frame) throw std::runtime_error("the server sent something that is not a reply: " + why);
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(protocol::kHeaderBytes + length));
  return frame;
}

std::string RawClient::text() {
  read();
  std::string all(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
  bytes_.clear();
  return all;
}

bool RawClient::closed() {
  read();
  return end_seen_ && bytes_.empty();
}

void RawClient::finish_sending() {
  ::shutdown(fd_, SHUT_WR);
}

void RawClient::reset() {
  const linger hard{1, 0};
  checked(::setsockopt(fd_, SOL_SOCKET, SO_LINGER, &hard, sizeof hard), "SO_LINGER");
  close();
}

std::vector<std::byte> frame_of(std::uint64_t id, const protocol::Request& request) {
  std::vector<std::byte> frame;
  protocol::encode_request(id, request, frame);
  return frame;
}

std::vector<std::byte> header_of(std::uint32_t length) {
  std::vector<std::byte> header;
  for (int i = 0; i < 4; ++i) header.push_back(static_cast<std::byte>(length >> (8 * i)));
  return header;
}

}  // namespace visum::testing

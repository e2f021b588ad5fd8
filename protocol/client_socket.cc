#include "protocol/client_socket.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include "protocol/client.h"
#include "protocol/codec.h"
#include "protocol/local_socket.h"
#include "protocol/socket_options.h"

namespace visum::protocol {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kFarewell{250};
constexpr std::size_t kCipheredBytes = 16u << 10;  // about one TLS record
constexpr const char* kClosed = "the server closed the connection";
// The kernel repeats an unanswered attempt to connect after 1, 3, 7, 15 s. Beginning anew connects sooner
// once a cut cable is back. Each attempt is longer than the one before, because an answer may take long.
constexpr std::chrono::seconds kFirstAttempt{1}, kLongestAttempt{4};
// With more time left than this, receive() sleeps in recv() itself over TCP, for so long at a time. That is
// one system call instead of two.
constexpr std::chrono::seconds kSlice{1};

std::string place(const std::string& host, std::uint16_t port) {
  const bool v6 = host.find(':') != std::string::npos;
  return (v6 ? "[" + host + "]" : host) + ":" + std::to_string(port);
}

// The timeout for poll(), rounded up, so that a wait never ends early and never spins.
int milliseconds_until(Deadline deadline) {
  if (deadline == kNever) return -1;
  const auto left = std::chrono::ceil<milliseconds>(deadline - steady_clock::now()).count();
  return static_cast<int>(std::clamp<std::int64_t>(left, 0, 1'000'000'000));
}

// Returns false if the deadline passed.
bool wait_for(int fd, short events, Deadline deadline) {
  for (;;) {
    pollfd poll_fd{fd, events, 0};
    const int timeout = milliseconds_until(deadline);
    const int ready = ::poll(&poll_fd, 1, timeout);
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) throw ConnectionError(std::string("poll: ") + std::strerror(errno));
    if (ready == 0 && steady_clock::now() >= deadline) return false;
  }
}

using AddressList = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

AddressList resolve(const std::string& host, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int failure = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &list);
  if (failure != 0) throw ConnectionError("cannot find the host '" + host + "': " + ::gai_strerror(failure));
  return {list, ::freeaddrinfo};
}

void let_receive_block(int fd) {
  const timeval slice{kSlice.count(), 0};
  ::setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &slice, sizeof slice);
  ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) & ~O_NONBLOCK);
}

// Returns 0 or an errno.
int connect_within(int fd, const addrinfo& address, Deadline deadline) {
  if (::connect(fd, address.ai_addr, address.ai_addrlen) == 0) return 0;
  if (errno != EINPROGRESS && errno != EINTR) return errno;
  if (!wait_for(fd, POLLOUT, deadline)) return ETIMEDOUT;
  int error = 0;
  socklen_t size = sizeof error;
  ::getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
  return error;
}

[[noreturn]] void fail_to_connect(const std::string& where, int error) {
  if (error == ECONNREFUSED) throw ConnectionError("nothing listens at " + where + " (is visumd running?)");
  if (error == ETIMEDOUT) throw ConnectionError("no answer from " + where);
  throw ConnectionError("cannot connect to " + where + ": " + std::strerror(error));
}

bool would_block() {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}

// The error text that a server without TLS sends in answer to TLS, if it can be read.
std::string plain_words(std::span<const std::byte> answer) {
  std::string why;
  if (answer.size() <= kHeaderBytes) return {};
  const auto reply = decode_reply(answer.subspan(kHeaderBytes), why);
  const auto* error = reply ? std::get_if<Error>(&reply->reply) : nullptr;
  return error ? ": " + error->text : std::string();
}

std::unique_ptr<TlsContext> make_client_context(const TlsFiles& files) try {
  return std::make_unique<TlsContext>(files, TlsContext::Side::kClient);
} catch (const std::runtime_error& error) {
  throw RequestError(ErrorCode::kUnauthenticated, error.what());
}

// True for a TLS handshake or alert.
bool is_tls_answer(std::span<const std::byte> answer) {
  constexpr std::byte kAlert{0x15};
  return looks_like_tls(answer) || answer[0] == kAlert;
}

}  // namespace

ClientSocket::ClientSocket(const std::string& host, std::uint16_t port, const TlsFiles& tls,
                           Deadline deadline) {
  if (!tls.given() && connect_locally(host, port)) return;
  connect(host, port, deadline);
  try {
    if (tls.given()) shake_hands(host, tls, deadline);
  } catch (...) {
    ::close(fd_);
    throw;
  }
}

bool ClientSocket::connect_locally(const std::string& host, std::uint16_t port) {
  const std::string name = local_socket_name(port);
  if (name.empty() || host != "127.0.0.1") return false;
  const int fd = ::socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd < 0) return false;
  const LocalAddress local = local_address(name);
  if (::connect(fd, reinterpret_cast<const sockaddr*>(&local.address), local.size) != 0) {
    ::close(fd);
    return false;
  }
  fd_ = fd;
  is_local_ = true;
  return true;
}

// Tries all addresses again and again until one answers, one refuses, or the deadline passes.
void ClientSocket::connect(const std::string& host, std::uint16_t port, Deadline deadline) {
  const AddressList addresses = resolve(host, port);
  int error = ETIMEDOUT;
  for (auto attempt = kFirstAttempt; error == ETIMEDOUT; attempt = std::min(2 * attempt, kLongestAttempt)) {
    error = connect_to_any(addresses.get(), deadline, attempt);
    if (steady_clock::now() >= deadline) break;
  }
  if (error != 0) fail_to_connect(place(host, port), error);
  // A wait for the world has no time limit, so the kernel must notice a server whose machine is gone.
  set_tcp_options(fd_);
  let_receive_block(fd_);
}

int ClientSocket::connect_to_any(const addrinfo* addresses, Deadline deadline, std::chrono::seconds attempt) {
  int error = EADDRNOTAVAIL;
  for (const addrinfo* address = addresses; address; address = address->ai_next) {
    const int fd = ::socket(address->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (fd < 0) {
      error = errno;
      continue;
    }
    error = connect_within(fd, *address, std::min(deadline, steady_clock::now() + attempt));
    if (error == 0) {
      fd_ = fd;
      return 0;
    }
    ::close(fd);
  }
  return error;
}

ClientSocket::~ClientSocket() {
  if (fd_ >= 0) ::close(fd_);
}

// ---------------------------------------- TLS

// Feeds the TLS stream with what arrives and sends what it has pending, until both certificates are accepted.
void ClientSocket::shake_hands(const std::string& host, const TlsFiles& files, Deadline deadline) {
  context_ = make_client_context(files);
  tls_ = std::make_unique<TlsStream>(*context_, host);
  ciphered_.resize(kCipheredBytes);
  bool first = true;
  while (tls_->write({}), !tls_->established()) {
    check_tls();
    while (!send_pending())
      if (!wait_for(fd_, POLLOUT, deadline)) throw ConnectionError("no answer to the TLS handshake");
    if (!wait_for(fd_, POLLIN, deadline)) throw ConnectionError("no answer to the TLS handshake");
    const std::size_t got = receive_raw(ciphered_, MSG_DONTWAIT);
    const auto answer = std::span<const std::byte>(ciphered_).first(got);
    if (std::exchange(first, false) && !is_tls_answer(answer))
      throw RequestError(ErrorCode::kUnauthenticated, "the server does not speak TLS" + plain_words(answer));
    tls_->feed(answer);
  }
  send_pending();
}

void ClientSocket::check_tls() const {
  if (!tls_->failure().empty()) throw RequestError(ErrorCode::kUnauthenticated, tls_->failure());
}

bool ClientSocket::send_pending() {
  for (auto pending = tls_->pending(); !pending.empty(); pending = tls_->pending()) {
    const std::size_t sent = send_raw(pending);
    if (sent == 0) return false;
    tls_->sent(sent);
  }
  return true;
}

bool ClientSocket::has_unsent() {
  return tls_ && !tls_->pending().empty();
}

std::size_t ClientSocket::send(std::span<const std::byte> bytes) {
  if (!tls_) return send_raw(bytes);
  if (!send_pending()) return 0;
  const std::size_t taken = tls_->write(bytes);
  check_tls();
  send_pending();
  return taken;
}

std::size_t ClientSocket::receive_with(std::span<std::byte> into, int flags) {
  if (!tls_) return receive_raw(into, flags);
  for (;;) {
    const std::size_t bytes = tls_->read(into);
    send_pending();
    if (bytes > 0) return bytes;
    check_tls();
    if (tls_->ended()) throw ConnectionError(kClosed);
    const std::size_t got = receive_raw(ciphered_, flags);
    if (got == 0) return 0;
    tls_->feed(std::span<const std::byte>(ciphered_).first(got));
  }
}

std::size_t ClientSocket::send_raw(std::span<const std::byte> bytes) {
  const ssize_t sent = ::send(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent >= 0) return static_cast<std::size_t>(sent);
  if (would_block()) return 0;
  throw ConnectionError(std::string("the connection to the server is gone: ") + std::strerror(errno));
}

bool ClientSocket::wait_to_send(Deadline deadline) const {
  return wait_for(fd_, POLLIN | POLLOUT, deadline);
}

std::size_t ClientSocket::receive_raw(std::span<std::byte> into, int flags) {
  const ssize_t received = ::recv(fd_, into.data(), into.size(), flags);
  if (received > 0) return static_cast<std::size_t>(received);
  if (received == 0) throw ConnectionError(kClosed);
  if (would_block()) return 0;
  throw ConnectionError(std::string("the connection to the server is gone: ") + std::strerror(errno));
}

std::size_t ClientSocket::receive(std::span<std::byte> into) {
  return receive_with(into, MSG_DONTWAIT);
}

std::size_t ClientSocket::receive(std::span<std::byte> into, Deadline deadline) {
  std::size_t at_once = 0;
  const std::chrono::nanoseconds left =
      deadline == kNever ? std::chrono::nanoseconds::max() : deadline - steady_clock::now();
  if (busy_wait_.find([&] { return (at_once = receive(into)) > 0; }, left)) return at_once;
  if (is_local_) return receive_locally(into, deadline);
  while (deadline == kNever || deadline - steady_clock::now() >= kSlice)
    if (const std::size_t received = receive_with(into, 0)) return received;
  do {
    if (const std::size_t received = receive(into)) return received;
  } while (wait_for(fd_, POLLIN, deadline));
  return 0;
}

// Sleeps in poll(): in recv(), a Unix socket would also be woken when the server takes what we sent.
std::size_t ClientSocket::receive_locally(std::span<std::byte> into, Deadline deadline) {
  while (wait_for(fd_, POLLIN, deadline))
    if (const std::size_t received = receive(into)) return received;
  return 0;
}

void ClientSocket::finish() noexcept {
  if (fd_ < 0) return;
  try {
    if (tls_) tls_->finish();
    if (tls_) send_pending();
    if (::shutdown(fd_, SHUT_WR) != 0) return;
    std::array<std::byte, 4096> ignored;
    const Deadline deadline = steady_clock::now() + kFarewell;
    while (wait_for(fd_, POLLIN, deadline)) receive(ignored);
  } catch (const std::runtime_error&) {
    // The server has closed the connection, as wanted.
  }
}

}  // namespace visum::protocol

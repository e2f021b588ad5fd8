// A connected TCP socket of the client, in plain text or over TLS: POSIX, non-blocking inside, blocking with
// deadlines outside. Internal to client.cc. Throws ConnectionError where the connection is gone, RequestError
// where TLS refuses it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "protocol/tls.h"

struct addrinfo;

namespace visum::protocol {

using Deadline = std::chrono::steady_clock::time_point;
inline constexpr Deadline kNever = Deadline::max();

class ClientSocket {
 public:
  // Tries each address of `host` (a name, IPv4 or IPv6) until one answers; then, where there are `tls` files,
  // the handshake.
  ClientSocket(const std::string& host, std::uint16_t port, const TlsFiles& tls, Deadline deadline);
  ~ClientSocket();
  ClientSocket(const ClientSocket&) = delete;
  ClientSocket& operator=(const ClientSocket&) = delete;

  int fd() const { return fd_; }

  // What goes out without waiting.
  std::size_t send(std::span<const std::byte> bytes);
  // Whether something that send() took still waits here; send({}) sends it.
  bool has_unsent();
  bool is_secure() const { return tls_ != nullptr; }
  // Until there is room to write, or something to read. False where the deadline passed.
  bool wait_to_send(Deadline deadline) const;
  // What is there, without waiting; 0: nothing yet.
  std::size_t receive(std::span<std::byte> into);
  // Waits for something to be there; 0: the deadline passed. Spins for `spin` before it sleeps.
  std::size_t receive(std::span<std::byte> into, Deadline deadline, std::chrono::nanoseconds spin);

  // Tells the server that no more comes, and waits a moment for it to close, so that nothing sent is lost.
  void finish() noexcept;

 private:
  void connect(const std::string& host, std::uint16_t port, Deadline deadline);
  int connect_to_any(const addrinfo* addresses, Deadline deadline,
                     std::chrono::seconds attempt);  // once each; 0, or errno
  void shake_hands(const std::string& host, const TlsFiles& files, Deadline deadline);
  std::size_t send_raw(std::span<const std::byte> bytes);
  bool send_pending();
  std::size_t receive_raw(std::span<std::byte> into, int flags);
  std::size_t receive_with(std::span<std::byte> into, int flags);
  void check_tls() const;

  int fd_ = -1;
  std::unique_ptr<TlsContext> context_;
  std::unique_ptr<TlsStream> tls_;   // null: plain text
  std::vector<std::byte> ciphered_;  // as read, where there is TLS
};

}  // namespace visum::protocol

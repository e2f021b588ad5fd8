// The client's connected socket: TCP, in plain text or over TLS, or a Unix socket. The calls here block up to
// a deadline. Owned by a Connection (client.cc), used on its thread. Throws ConnectionError if the connection
// is lost, and RequestError if TLS fails.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "protocol/busy_wait.h"
#include "protocol/tls.h"

struct addrinfo;

namespace visum::protocol {

using Deadline = std::chrono::steady_clock::time_point;
inline constexpr Deadline kNever = Deadline::max();

class ClientSocket {
 public:
  // Tries each address of `host` (a name, IPv4 or IPv6) until one answers. If `tls` names files, makes the
  // TLS handshake then.
  ClientSocket(const std::string& host, std::uint16_t port, const TlsFiles& tls, Deadline deadline);
  ~ClientSocket();
  ClientSocket(const ClientSocket&) = delete;
  ClientSocket& operator=(const ClientSocket&) = delete;

  int fd() const { return fd_; }

  // Sends what can be sent without waiting. Returns how many of the bytes were taken.
  std::size_t send(std::span<const std::byte> bytes);
  // True if bytes that send() took still wait here (encrypted, for TLS). send({}) tries to send them.
  bool has_unsent();
  bool is_secure() const { return tls_ != nullptr; }
  // Waits until there is room to write or something to read. Returns false if the deadline passed.
  bool wait_to_send(Deadline deadline) const;
  // Receives what is there, without waiting. Returns 0 if nothing is there yet.
  std::size_t receive(std::span<std::byte> into);
  // Waits until something arrives. Returns 0 if the deadline passed.
  std::size_t receive(std::span<std::byte> into, Deadline deadline);

  // Tells the server that no more comes and waits up to 250 ms for it to close, so that nothing sent is lost.
  void finish() noexcept;

 private:
  // Connects to the Unix socket beside the port (local_socket.h), without waiting. False: there is none.
  bool connect_locally(const std::string& host, std::uint16_t port);
  // Connects before the deadline, or throws. A try without an answer begins anew after 1, 2, then every 4 s.
  void connect(const std::string& host, std::uint16_t port, Deadline deadline);
  // Tries each address once, each for at most `attempt`. Returns 0 or an errno.
  int connect_to_any(const addrinfo* addresses, Deadline deadline, std::chrono::seconds attempt);
  void shake_hands(const std::string& host, const TlsFiles& files, Deadline deadline);
  std::size_t send_raw(std::span<const std::byte> bytes);
  // Sends what TLS has encrypted. Returns false if the socket takes no more now.
  bool send_pending();
  std::size_t receive_raw(std::span<std::byte> into, int flags);
  std::size_t receive_with(std::span<std::byte> into, int flags);
  std::size_t receive_locally(std::span<std::byte> into, Deadline deadline);
  // Throws if TLS has failed.
  void check_tls() const;

  int fd_ = -1;
  bool is_local_ = false;  // a Unix socket
  BusyWait busy_wait_;
  std::unique_ptr<TlsContext> context_;
  std::unique_ptr<TlsStream> tls_;   // null: plain text
  std::vector<std::byte> ciphered_;  // as received, when the connection uses TLS
};

}  // namespace visum::protocol

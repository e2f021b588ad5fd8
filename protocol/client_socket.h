// A connected TCP socket of the client: POSIX, non-blocking inside, blocking with deadlines outside. Internal
// to client.cc. Throws ConnectionError where the connection is gone.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace visum::protocol {

using Deadline = std::chrono::steady_clock::time_point;
inline constexpr Deadline kNever = Deadline::max();

class ClientSocket {
 public:
  // Tries each address of `host` (a name, IPv4 or IPv6) until one answers.
  ClientSocket(const std::string& host, std::uint16_t port, Deadline deadline);
  ~ClientSocket();
  ClientSocket(const ClientSocket&) = delete;
  ClientSocket& operator=(const ClientSocket&) = delete;

  int fd() const { return fd_; }

  // What is there, without waiting; 0: nothing yet.
  std::size_t receive(std::span<std::byte> into);
  // What goes out without waiting.
  std::size_t send(std::span<const std::byte> bytes);
  // Until there is something to read (or, where asked for, room to write). False where the deadline passed.
  // Spins for `spin` before it sleeps.
  bool wait(bool for_writing, Deadline deadline, std::chrono::nanoseconds spin = {}) const;

  // Tells the server that no more comes, and waits a moment for it to close, so that nothing sent is lost.
  void finish() noexcept;

 private:
  int fd_ = -1;
};

}  // namespace visum::protocol

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

  // What goes out without waiting.
  std::size_t send(std::span<const std::byte> bytes);
  // Until there is room to write, or something to read. False where the deadline passed.
  bool wait_to_send(Deadline deadline) const;
  // What is there, without waiting; 0: nothing yet.
  std::size_t receive(std::span<std::byte> into);
  // Waits for something to be there; 0: the deadline passed. Spins for `spin` before it sleeps.
  std::size_t receive(std::span<std::byte> into, Deadline deadline, std::chrono::nanoseconds spin);

  // Tells the server that no more comes, and waits a moment for it to close, so that nothing sent is lost.
  void finish() noexcept;

 private:
  std::size_t receive_with(std::span<std::byte> into, int flags);

  int fd_ = -1;
};

}  // namespace visum::protocol

// A bare TCP echo on loopback, to compare with a round trip through the protocol, which cannot be faster.
// Blocking POSIX sockets, TCP_NODELAY, one client. The server sends `reply_bytes` for each `request_bytes`.
// Throws std::system_error if a system call fails.
#pragma once

#include <cstddef>
#include <cstdint>
#include <thread>
#include <vector>

namespace visum::testing {

class RawEchoServer {
 public:
  RawEchoServer(std::size_t request_bytes, std::size_t reply_bytes);
  ~RawEchoServer();  // call it after the client is gone
  RawEchoServer(const RawEchoServer&) = delete;
  RawEchoServer& operator=(const RawEchoServer&) = delete;

  std::uint16_t port() const { return port_; }
  // The thread that answers, for example to pin it to a core.
  std::thread::native_handle_type thread() { return thread_.native_handle(); }

 private:
  void serve();

  const std::size_t request_bytes_, reply_bytes_;
  int listener_ = -1;
  std::uint16_t port_ = 0;
  std::thread thread_;
};

class RawEchoClient {
 public:
  RawEchoClient(std::uint16_t port, std::size_t request_bytes, std::size_t reply_bytes);
  ~RawEchoClient();
  RawEchoClient(const RawEchoClient&) = delete;
  RawEchoClient& operator=(const RawEchoClient&) = delete;

  void round_trip();

 private:
  int socket_;
  std::vector<std::byte> request_, reply_;
};

}  // namespace visum::testing

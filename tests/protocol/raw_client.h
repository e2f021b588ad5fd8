// A client that can misbehave: it sends exactly what it is told, in pieces if wanted, reads only when asked,
// and can reset the connection instead of closing it. It does not block; the test serves while it waits
// (fixture.h). Throws std::system_error if a system call fails.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "protocol/codec.h"
#include "protocol/limits.h"

namespace visum::testing {

class RawClient {
 public:
  struct Options {
    std::string address = "127.0.0.1";  // or "::1"
    std::string from = {};              // our own address, such as "127.0.0.2"; "": the system's choice
    int receive_buffer = 0;             // bytes; 0: the system's choice
  };
  explicit RawClient(std::uint16_t port) : RawClient(port, Options()) {}
  RawClient(std::uint16_t port, const Options& options);
  ~RawClient();
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  // Returns how many bytes the system took: 0 if it takes no more for now, or if the connection is gone.
  std::size_t send(std::span<const std::byte> bytes);
  void send(std::uint64_t id, const protocol::Request& request);
  void send_hello(protocol::Role role, const std::string& name = "tester");

  // Reads what is there. Returns the oldest unread reply if a whole one has arrived.
  std::optional<protocol::ReplyFrame> reply();
  // For a server that does not speak in frames: what has come and was not read yet.
  std::string text();
  bool closed();  // the server closed the connection, and every reply was read

  void finish_sending();  // FIN
  void reset();           // RST

 private:
  void read();
  void close();

  int fd_ = -1;
  bool end_seen_ = false;
  std::vector<std::byte> bytes_;
};

std::vector<std::byte> frame_of(std::uint64_t id, const protocol::Request& request);
// A frame's header that announces so many bytes.
std::vector<std::byte> header_of(std::uint32_t length);

}  // namespace visum::testing

// A browser's part in tests of the HTTP port: one request a connection, or a session over WebSocket.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "protocol/codec.h"

namespace visum::testing {

struct HttpAnswer {
  int status = 0;
  std::map<std::string, std::string> fields;  // names in lower case
  std::string body;
};

// `fields`: beside Host, or instead of it. Throws boost::system::system_error where the connection fails.
HttpAnswer http_request(std::uint16_t port, const std::string& method, const std::string& target,
                        const std::map<std::string, std::string>& fields = {},
                        const std::string& address = "127.0.0.1");

inline HttpAnswer http_get(std::uint16_t port, const std::string& target,
                           const std::map<std::string, std::string>& fields = {}) {
  return http_request(port, "GET", target, fields);
}

// Blocking. Throws boost::system::system_error where the server closes or refuses.
class WebClient {
 public:
  explicit WebClient(std::uint16_t port, const std::string& origin = "", bool compresses = false);
  ~WebClient();

  void send(std::uint64_t id, const protocol::Request& request);
  void send_text(const std::string& text);
  void send_bytes(std::span<const std::byte> bytes);  // the server may close before it has read all
  protocol::ReplyFrame next();                        // the next reply, sample or event
  // Skips samples and events.
  template <typename T>
  T ask(const protocol::Request& request) {
    send(++last_id_, request);
    for (;;) {
      auto frame = next();
      if (frame.reply_to == last_id_) return std::get<T>(std::move(frame.reply));
    }
  }
  // The code of RFC 6455 with which the server closes the connection. Reads all messages before it.
  int closing_code();
  void say_goodbye();                     // the closing handshake, begun by the page
  std::uint64_t received_bytes() const;   // so far, of messages
  std::uint64_t wire_bytes() const;       // so far, as they came over the socket
  std::uint64_t longest_message() const;  // bytes, of those that were received

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
  std::uint64_t last_id_ = 0;
};

}  // namespace visum::testing

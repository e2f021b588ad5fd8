// The client's end of the TCP session: blocking, one thread. Requests are answered in order of arrival;
// samples and events that come in between are kept (bounded: the latest sample of a stream wins, events up to
// 1024). Plain POSIX sockets inside client.cc, so that a client costs no Asio.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "protocol/messages.h"
#include "protocol/tls.h"

namespace visum::protocol {

// The server's refusal of a request, or (kTimeout, kInternal with no text from the server) the connection's
// own trouble.
class RequestError : public std::runtime_error {
 public:
  RequestError(ErrorCode code, const std::string& text, std::string owner = {})
      : std::runtime_error(text), code_(code), owner_(std::move(owner)) {}
  ErrorCode code() const { return code_; }
  const std::string& owner() const { return owner_; }

 private:
  ErrorCode code_;
  std::string owner_;
};

// The connection could not be made, or is gone.
class ConnectionError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class Connection {
 public:
  // Connects, over TLS where there are files for it, and says hello. Throws ConnectionError, or RequestError
  // where the server, or TLS on either side, refused.
  Connection(const std::string& host, std::uint16_t port, const Hello& hello,
             std::chrono::milliseconds timeout = std::chrono::seconds(5), const TlsFiles& tls = {});
  ~Connection();  // closes in good order
  Connection(Connection&&) noexcept;
  Connection& operator=(Connection&&) noexcept;

  const Welcome& welcome() const;

  // Sends a request and waits for its reply. Throws RequestError if that is an Error or does not come in time
  // (no timeout: Advance and Step wait as long as the world takes).
  Reply request(const Request& request);
  template <typename T>
  T request_as(const Request& message) {
    Reply reply = request(message);
    if (auto* value = std::get_if<T>(&reply)) return std::move(*value);
    throw RequestError(ErrorCode::kMalformed, "the server answered with a message of another kind");
  }
  // Sends without asking for a reply; a refusal arrives as an Error from next().
  void post(const Request& request);
  // Several requests in flight: send() now, wait() for the reply to that id later.
  std::uint64_t send(const Request& request);
  // The same, which leaves with what is sent next, or once something is waited for.
  std::uint64_t send_along(const Request& request);
  // The same for several at once, which leave, and mostly arrive, together. Their ids, in the same order.
  std::vector<std::uint64_t> send_together(const std::vector<Request>& requests);
  Reply wait(std::uint64_t id);
  // The same for at most `timeout`; nothing if it did not come by then: it can still be waited for.
  std::optional<Reply> wait_for(std::uint64_t id, std::chrono::milliseconds timeout);

  // The next sample or event, waiting up to `timeout`; nothing if none came.
  std::optional<Reply> next(std::chrono::milliseconds timeout);

  int native_handle() const;  // for poll()
  void set_spin(
      std::chrono::microseconds spin);  // busy-polls this long before it blocks; 0 (default): blocks at once

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// "HOST:PORT", "[::1]:PORT" or "PORT". Throws std::invalid_argument that says what is wrong.
std::pair<std::string, std::uint16_t> parse_address(const std::string& text);

}  // namespace visum::protocol

// The client's end of a session over TCP or TLS. A Connection blocks and belongs to one thread, the one that
// calls it. The server answers requests in the order of their arrival. Samples and events that arrive in
// between are kept for next(): the newest sample of each stream, and the newest 1024 events. client.cc uses
// plain POSIX sockets, so that a client does not have to build Asio.
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

// The server refused a request. Also thrown when no answer came in time (kTimeout), and when the server's
// answer was of an unexpected kind.
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

// The connection could not be made, or it is lost.
class ConnectionError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// One session with a server, open from the constructor to the destructor. The caller owns it. Once a
// ConnectionError was thrown, the connection is of no more use.
class Connection {
 public:
  // Connects, makes the TLS handshake if `tls` names files, and says hello; `timeout` bounds all of it
  // together, and later the wait for each reply. Throws ConnectionError if that fails, and RequestError if
  // the server refuses or if TLS fails on either side.
  Connection(const std::string& host, std::uint16_t port, const Hello& hello,
             std::chrono::milliseconds timeout = std::chrono::seconds(5), const TlsFiles& tls = {});
  ~Connection();  // tells the server that no more comes, and waits up to 250 ms for it to close
  Connection(Connection&&) noexcept;
  Connection& operator=(Connection&&) noexcept;

  const Welcome& welcome() const;

  // Sends a request and waits for its reply. Throws RequestError if the reply is an Error or does not come in
  // time. Advance, Step and LoadScene have no time limit: they take as long as the world takes.
  Reply request(const Request& request);
  // As request(). Throws RequestError (kMalformed) if the reply is not a T.
  template <typename T>
  T request_as(const Request& message) {
    Reply reply = request(message);
    if (auto* value = std::get_if<T>(&reply)) return std::move(*value);
    throw RequestError(ErrorCode::kMalformed, "the server answered with a message of another kind");
  }
  // Sends a request without an id: the server sends no reply. If it refuses, next() returns the Error.
  void post(const Request& request);
  // For several requests in flight: send() returns the id of the request, wait() takes it to wait for the
  // reply.
  std::uint64_t send(const Request& request);
  // As send(), but the request leaves together with the next one that is sent, or at the next wait.
  std::uint64_t send_along(const Request& request);
  // As send() for several requests, which leave together and mostly arrive together. Returns their ids in
  // order.
  std::vector<std::uint64_t> send_together(const std::vector<Request>& requests);
  // Waits for the reply to this request. Throws as request() does.
  Reply wait(std::uint64_t id);
  // As wait(), but for at most `timeout`. Returns nothing if no reply came by then; it can still be waited
  // for.
  std::optional<Reply> wait_for(std::uint64_t id, std::chrono::milliseconds timeout);

  // The next sample or event. Returns nothing if none came within `timeout`.
  std::optional<Reply> next(std::chrono::milliseconds timeout);

  // As next(), but only what was read already: it asks the socket for nothing.
  std::optional<Reply> next_kept();

  int native_handle() const;  // for poll()

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Reads "HOST:PORT", "[::1]:PORT" or "PORT" (of 127.0.0.1). Throws std::invalid_argument that says what is
// wrong.
std::pair<std::string, std::uint16_t> parse_address(const std::string& text);

}  // namespace visum::protocol

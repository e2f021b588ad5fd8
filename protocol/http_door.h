// The HTTP port. It accepts connections, bounds their number, answers requests for pages, and hands
// connections that upgrade to WebSocket to the server. The server owns it, and calls it on its thread. Only
// the constructor throws. Internal to the server; Boost.Beast stays inside http_connection.cc and
// web_session.cc.
#pragma once

#include <atomic>
#include <memory>
#include <vector>

#include "protocol/http_rules.h"
#include "protocol/listener.h"
#include "protocol/session_core.h"
#include "protocol/tls.h"

namespace visum::protocol {

class HttpConnection;
struct Upgrade;  // a socket, and the request that asked for WebSocket on it
struct UpgradeDeleter {
  void operator()(Upgrade* upgrade) const;
};
using UpgradePointer = std::unique_ptr<Upgrade, UpgradeDeleter>;

class HttpOwner {
 public:
  virtual ~HttpOwner() = default;
  virtual void http_connected() = 0;  // sweep() is needed from now on
  virtual void upgraded(UpgradePointer upgrade) = 0;
};

class HttpDoor {
 public:
  // `tls` is null for plain text. Otherwise it must outlive the door. Throws std::runtime_error if the port
  // cannot be had.
  HttpDoor(boost::asio::io_context& io, const std::string& address, WebOptions options, const TlsContext* tls,
           SessionContext& context, HttpOwner& owner);
  ~HttpDoor();

  std::uint16_t port() const { return listener_->port(); }
  void start() { listener_->start(); }
  void sweep();  // closes connections that take too long, and frees closed ones
  void close();  // closes the port and all connections
  bool busy() const { return !connections_.empty(); }
  std::size_t connection_count() const { return connections_.size(); }

 private:
  // Takes a new connection. If there are too many, another one yields its place, so that a health check or a
  // page is always answered.
  void admit(Listener::Socket socket, const boost::asio::ip::tcp::endpoint& peer);
  void make_room();
  void forget_finished();

  const WebOptions options_;
  const TlsContext* const tls_;
  SessionContext& context_;
  HttpOwner& owner_;
  std::unique_ptr<Listener> listener_;
  std::unique_ptr<HttpRules> rules_;
  std::vector<std::unique_ptr<HttpConnection>> connections_;
};

}  // namespace visum::protocol

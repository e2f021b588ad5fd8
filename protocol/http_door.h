// The HTTP port: accepts, bounds the number of connections, answers what pages there are, and hands those
// that upgrade to WebSocket to the server. Internal to the server; Boost.Beast stays inside
// http_connection.cc and web_session.cc.
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
  // `tls`: null for plain text; it must outlive the door.
  HttpDoor(boost::asio::io_context& io, const std::string& address, WebOptions options, const TlsContext* tls,
           SessionContext& context, HttpOwner& owner);
  ~HttpDoor();

  std::uint16_t port() const { return listener_->port(); }
  void start() { listener_->start(); }
  void sweep();  // closes what takes too long, forgets what is closed
  void close();  // the port and all connections
  bool busy() const { return !connections_.empty(); }
  std::size_t connection_count() const { return connections_.size(); }

 private:
  void admit(Listener::Socket socket, const boost::asio::ip::tcp::endpoint& peer);
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

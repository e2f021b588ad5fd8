// One HTTP connection. It reads one request after the other and answers each, or hands the socket on when a
// request upgrades to WebSocket. Lives on the server's thread; the HttpDoor owns it. An error of the socket
// or a late peer closes the connection; nothing throws. Internal to http_door.cc; Beast stays in
// http_connection.cc.
#pragma once

#include <memory>

#include "protocol/http_door.h"

namespace visum::protocol {

class HttpConnection {
 public:
  // `tls` is null for plain text. What is passed by reference or pointer must outlive the connection.
  HttpConnection(Listener::Socket socket, const boost::asio::ip::tcp::endpoint& peer, const TlsContext* tls,
                 const HttpRules& rules, WebPages& pages, SessionContext& context, HttpOwner& owner);
  ~HttpConnection();

  void start();  // begins to read
  void sweep();  // closes if the peer takes too long
  void close();
  bool is_open() const;
  // True between two requests, when the browser loses nothing if it must connect again.
  bool is_idle() const;
  ServedTime since() const;                         // the beginning of its present step
  const boost::asio::ip::address& address() const;  // of the peer
  bool finished() const;  // closed or handed on, and no operation is pending: it may be destroyed

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace visum::protocol

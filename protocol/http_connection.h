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
  HttpConnection(Listener::Socket socket, const TlsContext* tls, const HttpRules& rules, WebPages& pages,
                 SessionContext& context, HttpOwner& owner);
  ~HttpConnection();

  void start();  // begins to read
  void sweep();  // closes if the peer takes too long
  void close();
  bool finished() const;  // closed or handed on, and no operation is pending: it may be destroyed

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace visum::protocol

// One HTTP connection: reads heads of requests one after the other, answers each, or hands the socket on.
// Internal to http_door.cc; Beast stays in http_connection.cc.
#pragma once

#include <memory>

#include "protocol/http_door.h"

namespace visum::protocol {

class HttpConnection {
 public:
  // `tls`: null for plain text.
  HttpConnection(Listener::Socket socket, const TlsContext* tls, const HttpRules& rules, WebPages& pages,
                 SessionContext& context, HttpOwner& owner);
  ~HttpConnection();

  void start();
  void sweep();  // closes where the peer takes too long
  void close();
  bool finished() const;  // closed or handed on, and nothing of it pends

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace visum::protocol

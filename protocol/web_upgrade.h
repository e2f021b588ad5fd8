// A socket and the request that asked for WebSocket on it. http_connection.cc hands it to web_session.cc;
// only these two may include this header, because it is the one that knows Beast.
#pragma once

#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

#include "protocol/web_stream.h"

namespace visum::protocol {

struct Upgrade {
  WebStream stream;
  boost::beast::http::request<boost::beast::http::empty_body> request;
};

}  // namespace visum::protocol

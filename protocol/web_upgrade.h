// What http_connection.cc hands to web_session.cc: the only header that knows Beast, for those two alone.
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

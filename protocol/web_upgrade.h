// What http_connection.cc hands to web_session.cc: the only header that knows Beast, for those two alone.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>

namespace visum::protocol {

struct Upgrade {
  boost::asio::ip::tcp::socket socket;
  boost::beast::http::request<boost::beast::http::empty_body> request;
};

}  // namespace visum::protocol

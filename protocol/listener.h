// A listening socket. It binds at once, accepts after start(), at a bounded rate, and goes on when
// descriptors run out. The server or the HttpDoor owns it; it runs on the thread of its io_context. Only the
// constructor throws. Internal to the server; knows Asio.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <string>

#include "protocol/token_bucket.h"

namespace visum::protocol {

class Listener {
 public:
  using Socket = boost::asio::ip::tcp::socket;
  using OnSocket = std::function<void(Socket socket, const boost::asio::ip::tcp::endpoint& peer)>;

  // Throws std::runtime_error, with address and port in the text, if it cannot listen there.
  Listener(boost::asio::io_context& io, const std::string& address, std::uint16_t port,
           double accepts_per_second, OnSocket on_socket);

  std::uint16_t port() const { return port_; }
  void start() { accept_when_allowed(); }
  void close();  // stops to accept

 private:
  // Accepts now, or as soon as the rate allows it.
  void accept_when_allowed();
  void accept_after(std::chrono::nanoseconds pause);
  void on_accept(const boost::system::error_code& error, Socket socket);
  // Logs the first of a row of failures, and tries again after a pause.
  void accept_failed(const boost::system::error_code& error);

  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer timer_;
  TokenBucket accepts_;
  OnSocket on_socket_;
  std::uint16_t port_ = 0;
  bool failing_ = false;  // the last attempt failed
};

}  // namespace visum::protocol

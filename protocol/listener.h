// A listening socket: binds at once, accepts later, at a bounded rate, and goes on when descriptors run out.
// Internal to the server; knows Asio.
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

  // Throws std::runtime_error naming address and port where they cannot be had.
  Listener(boost::asio::io_context& io, const std::string& address, std::uint16_t port,
           double accepts_per_second, OnSocket on_socket);

  std::uint16_t port() const { return port_; }
  void start() { accept_when_allowed(); }
  void close();

 private:
  void accept_when_allowed();
  void accept_after(std::chrono::nanoseconds pause);
  void on_accept(const boost::system::error_code& error, Socket socket);
  void accept_failed(const boost::system::error_code& error);

  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer timer_;
  TokenBucket accepts_;
  OnSocket on_socket_;
  std::uint16_t port_ = 0;
  bool failing_ = false;
};

}  // namespace visum::protocol

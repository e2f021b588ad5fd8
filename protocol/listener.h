// A listening socket. It binds at once, accepts after start(), and goes on when descriptors run out. Accepted
// connections are handed on at a bounded rate, one address after the other, so that none keeps others
// waiting. The server or the HttpDoor owns it; it runs on the thread of its io_context. Only the constructor
// throws. Internal to the server; knows Asio.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <string>

#include "protocol/accept_line.h"
#include "protocol/token_bucket.h"

namespace visum::protocol {

class Listener {
 public:
  using Socket = boost::asio::ip::tcp::socket;
  using OnSocket = std::function<void(Socket socket, const boost::asio::ip::tcp::endpoint& peer)>;

  // `on_dropped` is told of each connection for which there was no place in the line. Throws
  // std::runtime_error, with address and port in the text, if it cannot listen there.
  Listener(boost::asio::io_context& io, const std::string& address, std::uint16_t port,
           double accepts_per_second, OnSocket on_socket, std::function<void()> on_dropped);

  std::uint16_t port() const { return port_; }
  void start() { accept(); }
  void close();  // stops to accept

 private:
  void accept();
  void accept_after(std::chrono::nanoseconds pause);
  void on_accept(const boost::system::error_code& error, Socket socket);
  // Hands on the next one, unless it is waited for already. The others follow one by one, as the rate allows
  // it: each may be read from before the next one comes.
  void hand_on();
  void hand_on_after(std::chrono::nanoseconds pause);
  // Logs the first of a row of failures, and tries again after a pause.
  void accept_failed(const boost::system::error_code& error);

  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer accept_timer_, hand_on_timer_;
  TokenBucket accepts_;  // more come than are handed on, so that each address has its turn
  TokenBucket handed_on_;
  bool hand_on_waits_ = false;
  AcceptLine line_;
  OnSocket on_socket_;
  std::function<void()> on_dropped_;
  std::uint16_t port_ = 0;
  bool failing_ = false;  // the last attempt failed
};

}  // namespace visum::protocol

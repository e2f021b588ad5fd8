// Accepts sessions on the Unix socket beside the server's TCP port (local_socket.h). All its clients are
// programs of one run, so it has neither a line nor a rate. The server owns it; it runs on the thread of its
// io_context. Only the constructor throws. Internal to the server; knows Asio.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <string>

namespace visum::protocol {

class LocalDoor {
 public:
  using Socket = boost::asio::local::stream_protocol::socket;

  // Throws std::runtime_error, with the name in the text, if it cannot listen there.
  LocalDoor(boost::asio::io_context& io, const std::string& name, std::function<void(Socket)> on_socket);

  void start() { accept(); }
  void close();

 private:
  void accept();

  boost::asio::local::stream_protocol::acceptor acceptor_;
  boost::asio::steady_timer pause_;  // after a failure, as when descriptors have run out
  std::function<void(Socket)> on_socket_;
};

}  // namespace visum::protocol

#include "protocol/local_door.h"

#include <chrono>
#include <stdexcept>
#include <utility>

namespace visum::protocol {
namespace {

using boost::asio::local::stream_protocol;
using boost::system::error_code;

constexpr std::chrono::milliseconds kPause{100};

}  // namespace

LocalDoor::LocalDoor(boost::asio::io_context& io, const std::string& name,
                     std::function<void(Socket)> on_socket) try
    // Asio takes a name that begins with a zero byte for an abstract one
    : acceptor_(io, stream_protocol::endpoint(std::string(1, '\0') + name)),
      pause_(io),
      on_socket_(std::move(on_socket)) {
} catch (const boost::system::system_error& error) {
  throw std::runtime_error("cannot listen on the Unix socket '@" + name + "': " + error.code().message());
}

void LocalDoor::close() {
  error_code ignored;
  acceptor_.close(ignored);
  pause_.cancel(ignored);
}

void LocalDoor::accept() {
  if (!acceptor_.is_open()) return;
  acceptor_.async_accept([this](const error_code& error, Socket socket) {
    if (!acceptor_.is_open()) return;
    if (!error) {
      on_socket_(std::move(socket));
      return accept();
    }
    pause_.expires_after(kPause);
    pause_.async_wait([this](const error_code& stopped) {
      if (!stopped) accept();
    });
  });
}

}  // namespace visum::protocol

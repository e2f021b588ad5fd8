#include "protocol/listener.h"

#include <spdlog/spdlog.h>

#include <boost/asio/ip/address.hpp>
#include <stdexcept>
#include <utility>

#include "protocol/wire_session.h"

namespace visum::protocol {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kAcceptBackoff{100};
constexpr int kBacklog = 512;

asio::ip::address address_of(const std::string& text) {
  if (text == "localhost") return asio::ip::address_v4::loopback();
  error_code error;
  const auto address = asio::ip::make_address(text, error);
  if (error) throw std::runtime_error("cannot listen on '" + text + "': it is not an IP address");
  return address;
}

}  // namespace

Listener::Listener(asio::io_context& io, const std::string& address, std::uint16_t port,
                   double accepts_per_second, OnSocket on_socket)
    : acceptor_(io),
      timer_(io),
      accepts_(accepts_per_second, steady_clock::now()),
      on_socket_(std::move(on_socket)) {
  const tcp::endpoint endpoint(address_of(address), port);
  try {
    acceptor_.open(endpoint.protocol());
    acceptor_.set_option(tcp::acceptor::reuse_address(true));
    acceptor_.bind(endpoint);
    acceptor_.listen(kBacklog);
    port_ = acceptor_.local_endpoint().port();
  } catch (const boost::system::system_error& error) {
    throw std::runtime_error("cannot listen on " + to_text(endpoint) + ": " + error.code().message());
  }
}

void Listener::close() {
  error_code ignored;
  acceptor_.close(ignored);
  timer_.cancel(ignored);
}

void Listener::accept_when_allowed() {
  if (!acceptor_.is_open()) return;
  if (!accepts_.take(steady_clock::now())) return accept_after(accepts_.wait());
  acceptor_.async_accept(
      [this](const error_code& error, Socket socket) { on_accept(error, std::move(socket)); });
}

void Listener::accept_after(std::chrono::nanoseconds pause) {
  timer_.expires_after(pause);
  timer_.async_wait([this](const error_code& error) {
    if (!error) accept_when_allowed();
  });
}

void Listener::on_accept(const error_code& error, Socket socket) {
  if (!acceptor_.is_open()) return;
  if (error && error != asio::error::connection_aborted) return accept_failed(error);
  failing_ = false;
  error_code gone = error;
  const auto peer = gone ? tcp::endpoint() : socket.remote_endpoint(gone);
  if (!gone) on_socket_(std::move(socket), peer);
  accept_when_allowed();
}

// Usually no descriptor is left. They come back when sessions end, so the pause is worth waiting for.
void Listener::accept_failed(const error_code& error) {
  if (!std::exchange(failing_, true))
    spdlog::warn("cannot accept connections on port {}: {}; trying again", port_, error.message());
  accept_after(kAcceptBackoff);
}

}  // namespace visum::protocol

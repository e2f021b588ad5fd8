#include "protocol/listener.h"

#include <spdlog/spdlog.h>

#include <boost/asio/ip/address.hpp>
#include <new>
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
constexpr double kAcceptsPerHandedOn = 10.0;

asio::ip::address address_of(const std::string& text) {
  if (text == "localhost") return asio::ip::address_v4::loopback();
  error_code error;
  const auto address = asio::ip::make_address(text, error);
  if (error) throw std::runtime_error("cannot listen on '" + text + "': it is not an IP address");
  return address;
}

// A connection that there is no memory for is closed by its destructor.
template <typename Function>
void if_memory_suffices(Function&& take_connection) {
  try {
    take_connection();
  } catch (const std::bad_alloc&) {
    spdlog::error("a connection is refused: not enough memory is left");
  }
}

}  // namespace

Listener::Listener(asio::io_context& io, const std::string& address, std::uint16_t port,
                   double accepts_per_second, OnSocket on_socket, std::function<void()> on_dropped)
    : acceptor_(io),
      accept_timer_(io),
      hand_on_timer_(io),
      accepts_(kAcceptsPerHandedOn * accepts_per_second, steady_clock::now()),
      handed_on_(accepts_per_second, steady_clock::now()),
      on_socket_(std::move(on_socket)),
      on_dropped_(std::move(on_dropped)) {
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
  accept_timer_.cancel(ignored);
  hand_on_timer_.cancel(ignored);
  line_.clear();
}

void Listener::accept() {
  if (!acceptor_.is_open()) return;
  if (!accepts_.take(steady_clock::now())) return accept_after(accepts_.wait());
  acceptor_.async_accept(
      [this](const error_code& error, Socket socket) { on_accept(error, std::move(socket)); });
}

void Listener::accept_after(std::chrono::nanoseconds pause) {
  accept_timer_.expires_after(pause);
  accept_timer_.async_wait([this](const error_code& error) {
    if (!error) accept();
  });
}

void Listener::hand_on() {
  if (hand_on_waits_ || line_.empty()) return;
  if (!handed_on_.take(steady_clock::now())) return hand_on_after(handed_on_.wait());
  auto taken = line_.take();  // Clang 14 lets no lambda capture a structured binding
  if_memory_suffices([&] { on_socket_(std::move(taken.first), taken.second); });
  hand_on_after({});
}

void Listener::hand_on_after(std::chrono::nanoseconds pause) {
  hand_on_waits_ = true;
  hand_on_timer_.expires_after(pause);
  hand_on_timer_.async_wait([this](const error_code& error) {
    hand_on_waits_ = false;
    if (!error) hand_on();
  });
}

void Listener::on_accept(const error_code& error, Socket socket) {
  if (!acceptor_.is_open()) return;
  if (error && error != asio::error::connection_aborted) return accept_failed(error);
  failing_ = false;
  error_code gone = error;
  const auto peer = gone ? tcp::endpoint() : socket.remote_endpoint(gone);
  if_memory_suffices([&] {
    if (!gone && !line_.add(std::move(socket), peer)) on_dropped_();
  });
  hand_on();
  accept();
}

// Usually no descriptor is left. They come back when sessions end, so the pause is worth waiting for.
void Listener::accept_failed(const error_code& error) {
  if (!std::exchange(failing_, true))
    spdlog::warn("cannot accept connections on port {}: {}; trying again", port_, error.message());
  accept_after(kAcceptBackoff);
}

}  // namespace visum::protocol

#include "protocol/tcp_session.h"

#include <netinet/in.h>
#include <netinet/tcp.h>

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/post.hpp>
#include <sstream>
#include <utility>

namespace visum::protocol {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

constexpr std::chrono::milliseconds kLinger{500};
constexpr std::size_t kMaxDiscarded = 1u << 20;

void set_option(int socket, int level, int name, int value) {
  ::setsockopt(socket, level, name, &value,
               sizeof value);  // an option that is refused leaves the kernel's default
}

// A peer that vanished without a word is found by the kernel: idle within 4 s by probes, while sending by the
// timeout.
void set_options(int socket) {
  set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(socket, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(socket, IPPROTO_TCP, TCP_KEEPIDLE, 1);
  set_option(socket, IPPROTO_TCP, TCP_KEEPINTVL, 1);
  set_option(socket, IPPROTO_TCP, TCP_KEEPCNT, 3);
  set_option(socket, IPPROTO_TCP, TCP_USER_TIMEOUT, 4000);
}

}  // namespace

std::string to_text(const asio::ip::tcp::endpoint& endpoint) {
  std::ostringstream text;
  text << endpoint;
  return text.str();
}

TcpSession::TcpSession(SessionContext& context, SessionOwner& owner, Socket socket, std::uint64_t id,
                       const asio::ip::tcp::endpoint& peer)
    : SessionCore(context, id, to_text(peer)),
      owner_(owner),
      socket_(std::move(socket)),
      address_(peer.address()) {
  error_code ignored;  // a socket that fails here fails again, and is seen, at the first read
  socket_.non_blocking(true, ignored);
  set_options(socket_.native_handle());
}

void TcpSession::start() {
  read();
}

void TcpSession::wake() {
  if (!std::exchange(woken_, true)) owner_.woken(*this);
}

void TcpSession::work() {
  woken_ = false;
  tell_closed();
  flush();
}

// ----------------------------------------------------------------------------------------------------
// reading

void TcpSession::read() {
  if (reading_ || !socket_.is_open()) return;
  reading_ = true;
  ++operations_;
  const auto space = in().space();
  socket_.async_read_some(asio::buffer(space.data(), space.size()),
                          [this](const error_code& error, std::size_t bytes) {
                            --operations_;
                            reading_ = false;
                            on_read(error, bytes);
                          });
}

void TcpSession::on_read(const error_code& error, std::size_t bytes) {
  if (!socket_.is_open()) return wake();
  if (error == asio::error::eof) {
    peer_gone_ = true;
    if (lingering_) return hang_up();
    return peer_closed();
  }
  if (error) return lost();
  if (closing()) return discard(bytes);
  in().commit(bytes);
  proceed();
}

// Closing with unread input would reset the connection, and the reset may overtake the reason that was sent.
void TcpSession::discard(std::size_t bytes) {
  discarded_ += bytes;
  if (discarded_ > kMaxDiscarded) return hang_up();
  in().clear();
  read();
}

void TcpSession::proceed() {
  switch (handle_frames()) {
    case Appetite::kMore:
      return read();
    case Appetite::kPaused:
      paused_ = true;
      return;
    case Appetite::kNone:
      return;
    case Appetite::kTurn:
      break;
  }
  if (std::exchange(turn_posted_, true)) return;
  ++operations_;
  asio::post(socket_.get_executor(), [this] {
    --operations_;
    turn_posted_ = false;
    if (!socket_.is_open()) return wake();
    proceed();
  });
}

// ----------------------------------------------------------------------------------------------------
// writing

void TcpSession::flush() {
  if (blocked_ || lingering_ || !socket_.is_open()) return;
  while (!out().empty()) {
    const auto bytes = out().front();
    error_code error;
    const std::size_t sent = socket_.write_some(asio::buffer(bytes.data(), bytes.size()), error);
    if (error == asio::error::would_block) return wait_until_writable();
    if (error) return lost();
    out().written(sent);
  }
  written_out();
}

void TcpSession::wait_until_writable() {
  blocked_ = true;
  blocked_since_ = context().now;
  ++operations_;
  socket_.async_wait(Socket::wait_write, [this](const error_code& error) {
    --operations_;
    blocked_ = false;
    if (!socket_.is_open()) return wake();
    if (error) return lost();
    flush();
  });
}

void TcpSession::written_out() {
  if (!closing()) {
    if (std::exchange(paused_, false)) proceed();
    return;
  }
  if (peer_gone_ || close_reason() != CloseReason::kRefused) return hang_up();
  lingering_ = true;
  lingering_since_ = context().now;
  error_code ignored;
  socket_.shutdown(Socket::shutdown_send, ignored);
  in().clear();
  read();
}

// ---------------------------------------------------------------------------------------------------- ending

void TcpSession::sweep() {
  if (!socket_.is_open()) return;
  check_deadlines();
  if (blocked_ && over(blocked_since_, context().limits.stall_deadline)) return lost();
  if (lingering_ && over(lingering_since_, kLinger)) hang_up();
}

void TcpSession::lost() {
  close(CloseReason::kLost);
  hang_up();
}

void TcpSession::hang_up() {
  error_code ignored;
  socket_.close(ignored);
  wake();
}

void TcpSession::let_go() {
  flush();
  if (socket_.is_open()) hang_up();
}

}  // namespace visum::protocol

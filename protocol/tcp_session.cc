#include "protocol/tcp_session.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>

namespace visum::protocol {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

constexpr std::chrono::milliseconds kLinger{500};
constexpr std::size_t kMaxDiscarded = 1u << 20;

}  // namespace

TcpSession::TcpSession(SessionContext& context, SessionOwner& owner, Socket socket, std::uint64_t id,
                       const asio::ip::tcp::endpoint& peer)
    : WireSession(context, owner, id, peer), socket_(std::move(socket)) {
  set_socket_options(socket_);
}

// Who was refused is not listened to before he was told.
void TcpSession::start() {
  if (!closing()) read();
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
  if (!closing()) return proceed_if_due();
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

void TcpSession::let_go() {
  flush();
  if (socket_.is_open()) hang_up();
}

}  // namespace visum::protocol

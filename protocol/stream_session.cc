#include "protocol/stream_session.h"

#include <boost/asio/buffer.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/post.hpp>
#include <new>
#include <utility>

#include "protocol/socket_options.h"

namespace visum::protocol {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

constexpr std::chrono::milliseconds kLinger{500};  // for the peer to read why it is refused
constexpr std::size_t kMaxDiscarded = 1u << 20;
constexpr std::size_t kCipheredBytes = 16u << 10;  // about a record of TLS

}  // namespace

StreamSession::StreamSession(SessionContext& context, SessionOwner& owner, Socket socket, std::uint64_t id,
                             const asio::ip::address& address, const std::string& peer)
    : WireSession(context, owner, id, address, peer), socket_(std::move(socket)) {
  error_code ignored;  // a socket that fails here fails again at the first read, where it is noticed
  socket_.non_blocking(true, ignored);
}

StreamSession::StreamSession(SessionContext& context, SessionOwner& owner, asio::ip::tcp::socket socket,
                             std::uint64_t id, const asio::ip::tcp::endpoint& peer, const TlsContext* tls)
    : StreamSession(context, owner, Socket(std::move(socket)), id, peer.address(), to_text(peer)) {
  set_tcp_options(socket_.native_handle());
  if (!tls) return;
  tls_ = std::make_unique<TlsStream>(*tls);
  ciphered_.resize(kCipheredBytes);
}

StreamSession::StreamSession(SessionContext& context, SessionOwner& owner,
                             asio::local::stream_protocol::socket socket, std::uint64_t id)
    : StreamSession(context, owner, Socket(std::move(socket)), id, asio::ip::address_v4::loopback(),
                    "a Unix socket") {}

std::string StreamSession::identity() const {
  return tls_ ? tls_->peer_name() : std::string();
}

// A session that the server refused at once writes the reason before it reads anything.
void StreamSession::start() {
  if (!closing()) read();
}

// ----------------------------------------------------------------------------------------------------
// reading

void StreamSession::read() {
  if (reading_ || looked_after_ || !socket_.is_open()) return;
  looked_after_ = drained_ && !tls_ && !closing() && !lingering_ && may_be_looked_after();
  if (!looked_after_) wait_to_read();
}

bool StreamSession::take_now() {
  const auto space = space_for_network();
  if (space.empty()) return looked_after_ = false;  // closed, for want of memory
  error_code error;
  const std::size_t bytes = socket_.read_some(asio::buffer(space.data(), space.size()), error);
  if (error == asio::error::would_block) return false;
  looked_after_ = false;
  on_read(error, bytes, space.size());
  return true;
}

void StreamSession::wait_for_bytes() {
  if (std::exchange(looked_after_, false) && socket_.is_open()) wait_to_read();
}

// Where memory runs out it costs this session, though the call may come from another one's handler.
void StreamSession::wait_to_read() try {
  const auto space = space_for_network();
  if (space.empty()) return;  // closed, for want of memory
  // Bytes are left to decipher. They wait for a turn of their own: other sessions come first, and
  // take_plain() does not call itself.
  if (tls_ && !fed_dry_ && !closing() && !lingering_)
    asio::post(executor(), [this] {
      --operations_;
      reading_ = false;
      if (!socket_.is_open()) return wake();
      if (!closing()) return take_plain();
      read();
    });
  else
    socket_.async_read_some(asio::buffer(space.data(), space.size()),
                            [this, size = space.size()](const error_code& error, std::size_t bytes) {
                              --operations_;
                              reading_ = false;
                              on_read(error, bytes, size);
                            });
  reading_ = true;  // neither calls us before it returns
  ++operations_;
} catch (const std::bad_alloc&) {
  lost();
}

void StreamSession::on_read(const error_code& error, std::size_t bytes, std::size_t space) {
  drained_ = bytes < space;
  context().handler.on_bytes();
  if (!socket_.is_open()) return wake();
  if (error == asio::error::eof) return stream_ended();
  if (error) return lost();
  if (closing() || lingering_) return discard(bytes);
  if (tls_) return decipher(bytes);
  in().commit(bytes);
  proceed();
}

void StreamSession::stream_ended() {
  peer_gone_ = true;
  if (lingering_) return hang_up();
  peer_closed();
}

std::span<std::byte> StreamSession::space_for_network() {
  return tls_ ? std::span(ciphered_) : room();
}

void StreamSession::decipher(std::size_t bytes) {
  const std::span<const std::byte> fresh = std::span(ciphered_).first(bytes);
  if (!fed_ && !looks_like_tls(fresh)) {
    tls_.reset();
    return refuse(0, {ErrorCode::kUnauthenticated,
                      "this server speaks TLS only, with certificates (--tls-ca, --tls-cert, --tls-key)",
                      {}});
  }
  fed_ = true;
  tls_->feed(fresh);
  take_plain();
}

void StreamSession::take_plain() {
  const auto space = room();
  if (space.empty()) return;
  const std::size_t bytes = tls_->read(space);
  wake();  // the handshake may have something to send
  if (!tls_->failure().empty()) return tls_failed();
  if (tls_->ended()) return stream_ended();
  fed_dry_ = bytes == 0;
  in().commit(bytes);
  proceed();
}

void StreamSession::tls_failed() {
  log(LogLevel::kWarning, peer() + " is refused: " + tls_->failure());
  context().refused.fetch_add(1, std::memory_order_relaxed);
  if (!awaits_hello()) return close(CloseReason::kRefused);
  // The session still counts against the limit of clients that have not said Hello. It lingers after flush(),
  // which take_plain() has asked for, has sent the alert.
  handshake_failed_ = true;
}

// Closing with unread input would reset the connection, and the reset may overtake the reason that was sent.
void StreamSession::discard(std::size_t bytes) {
  discarded_ += bytes;
  if (discarded_ > kMaxDiscarded) return hang_up();
  in().clear();
  read();
}

// ----------------------------------------------------------------------------------------------------
// writing

void StreamSession::flush() {
  if (lingering_ && close_reason() == CloseReason::kShutdown) return hang_up();
  if (blocked_ || lingering_ || !socket_.is_open()) return;
  for (auto bytes = bytes_for_network(); !bytes.empty(); bytes = bytes_for_network()) {
    error_code error;
    const std::size_t sent = socket_.write_some(asio::buffer(bytes.data(), bytes.size()), error);
    if (error == asio::error::would_block) return wait_until_writable();
    if (error) return lost();
    tls_ ? tls_->sent(sent) : out().written(sent);
  }
  written_out();
}

// With TLS the core's next batch is ciphered only after the one before has left: one record waits at most.
std::span<const std::byte> StreamSession::bytes_for_network() {
  if (!tls_) return out().empty() ? std::span<const std::byte>() : out().front();
  if (const auto pending = tls_->pending(); !pending.empty()) return pending;
  if (!out().empty()) out().written(tls_->write(out().front()));
  if (closing() && out().empty() && !std::exchange(said_goodbye_, true)) tls_->finish();
  return tls_->pending();
}

void StreamSession::wait_until_writable() {
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

void StreamSession::written_out() {
  if (handshake_failed_ && !closing()) return linger();
  if (!closing()) return proceed_if_due();
  if (peer_gone_ || close_reason() != CloseReason::kRefused) return hang_up();
  error_code ignored;
  socket_.shutdown(Socket::shutdown_send, ignored);
  linger();
}

// ----------------------------------------------------------------------------------------------------
// ending

void StreamSession::linger() {
  lingering_ = true;
  lingering_since_ = context().now;
  in().clear();
  read();
}

// A refused TLS client gets as long as one that says nothing at all. Our side stays open meanwhile: the alert
// has ended the stream already, and Chromium forgets the alert if it finds the connection ended before its
// request.
std::chrono::milliseconds StreamSession::linger_bound() {
  return handshake_failed_ ? context().limits.hello_deadline : kLinger;
}

void StreamSession::sweep() {
  if (!socket_.is_open()) return;
  if (lingering_) {
    if (over(lingering_since_, linger_bound())) hang_up();
    return;
  }
  check_deadlines();
  if (blocked_ && over(blocked_since_, context().limits.stall_deadline)) return lost();
}

void StreamSession::close_socket() {
  error_code ignored;
  looked_after_ = false;
  socket_.close(ignored);
}

void StreamSession::let_go() {
  flush();
  if (socket_.is_open()) hang_up();
}

}  // namespace visum::protocol

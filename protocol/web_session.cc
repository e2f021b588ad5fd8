#include "protocol/web_session.h"

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <optional>
#include <utility>

#include "protocol/codec.h"
#include "protocol/reading_window.h"
#include "protocol/web_upgrade.h"

namespace visum::protocol {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using boost::system::error_code;

constexpr std::chrono::milliseconds kGoodbyeTime{500};  // for the peer's half of the closing handshake

// Samples follow each other that are partly the same, so compression (RFC 7692) halves them. The window holds
// the last few: with it a session takes 70 kB more.
websocket::permessage_deflate compression() {
  websocket::permessage_deflate deflate;
  deflate.server_enable = true;
  deflate.server_max_window_bits = 13;
  deflate.client_max_window_bits = 13;
  deflate.compLevel = 1;
  deflate.memLevel = 5;
  return deflate;
}

websocket::close_code code_for(CloseReason reason) {
  if (reason == CloseReason::kShutdown) return websocket::close_code::going_away;
  return reason == CloseReason::kRefused ? websocket::close_code::policy_error
                                         : websocket::close_code::normal;
}

// Writes one piece of at most ReadingWindow::kPiece at a time, and only so far ahead as pongs confirm. Closes
// by WebSocket's closing handshake.
class WebSession final : public WireSession {
 public:
  WebSession(SessionContext& context, SessionOwner& owner, std::uint64_t id,
             const asio::ip::tcp::endpoint& peer, UpgradePointer upgrade)
      : WireSession(context, owner, id, peer.address(), to_text(peer)),
        stream_(std::move(upgrade->stream)),
        request_(std::move(upgrade->request)) {
    set_socket_options(socket());
    stream_.set_option(compression());
    stream_.binary(true);
    stream_.auto_fragment(false);
    stream_.read_message_max(context.limits.max_frame_admin + kHeaderBytes);
    stream_.control_callback([this](websocket::frame_type kind, boost::beast::string_view) {
      if (kind != websocket::frame_type::pong) return;
      window_.pong_came();
      wake();
    });
    stream_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
      response.set(http::field::sec_websocket_protocol, std::string(kWebSocketProtocol));
    }));
  }

  std::string identity() const override { return stream_.next_layer().identity(); }

  void start() override;
  void sweep() override;
  void let_go() override {
    if (is_open()) hang_up();
  }

 private:
  asio::ip::tcp::socket& socket() { return stream_.next_layer().socket(); }
  bool is_open() const override { return stream_.next_layer().socket().is_open(); }
  void close_socket() override {
    error_code ignored;
    socket().close(ignored);
  }
  asio::any_io_executor executor() override { return socket().get_executor(); }
  void read() override;
  void flush() override;

  void on_read(const error_code& error, std::size_t bytes);
  void write();
  void ping();           // its pong will confirm all that was sent before
  void written_out();    // the queue is empty: closes if that is due, or reads on
  void begin_closing();  // starts the closing handshake

  websocket::stream<WebStream> stream_;
  http::request<http::empty_body> request_;
  bool accepted_ = false;  // the handshake is answered
  bool reading_ = false;
  bool saying_goodbye_ = false;
  std::optional<ServedTime> writing_since_;
  ReadingWindow window_;
  ServedTime goodbye_since_{0};
};

void WebSession::start() {
  ++operations_;
  stream_.async_accept(request_, [this](const error_code& error) {
    --operations_;
    request_ = {};
    if (!is_open()) return wake();
    if (error) return lost();
    accepted_ = true;
    read();
    wake();
  });
}

// ---------------------------------------- reading

void WebSession::read() {
  if (reading_ || !is_open()) return;
  const auto space = room();
  if (space.empty()) return;  // closed, for want of memory
  reading_ = true;
  ++operations_;
  stream_.async_read_some(asio::buffer(space.data(), space.size()),
                          [this](const error_code& error, std::size_t bytes) {
                            --operations_;
                            reading_ = false;
                            on_read(error, bytes);
                          });
}

void WebSession::on_read(const error_code& error, std::size_t bytes) {
  const bool goodbye = error == websocket::error::closed;
  if (goodbye) peer_closed();  // the stream has already closed the socket
  if (goodbye || !is_open()) return wake();
  if (error) {
    if (!saying_goodbye_) lost();
    return;
  }
  if (closing()) {  // nothing is handled any more; read on until the peer closes
    in().clear();
    return read();
  }
  if (!stream_.got_binary()) return refuse(0, {ErrorCode::kMalformed, "a message that is not binary", {}});
  in().commit(bytes);
  proceed();
}

// ---------------------------------------- writing

void WebSession::flush() {
  if (!is_open()) return;
  if (closing() && accepted_ && !stream_.is_open()) return hang_up();
  if (!accepted_ || writing_since_ || saying_goodbye_) return;
  if (out().empty()) return written_out();
  // For a page that does not read, samples wait: the newest of each stream. While replies hold up requests,
  // or a reason must be told, write on: no pong would be read then, and the stall deadline ends a peer that
  // reads nothing.
  if (window_.open() || paused() || closing()) return write();
  // If more than a window was sent during such a pause, the pong from before it does not open the window.
  if (window_.ping_due()) ping();
}

// Sends each piece as a message of its own. A browser tells its page of a message only when all of it has
// arrived, and a page that hears nothing during a long frame would take the session for dead.
void WebSession::write() {
  const auto batch = out().front();
  const std::size_t bytes = std::min(batch.size(), ReadingWindow::kPiece);
  writing_since_ = context().now;
  ++operations_;
  stream_.async_write_some(true, asio::buffer(batch.data(), bytes),
                           [this, bytes](const error_code& error, std::size_t) {
                             --operations_;
                             writing_since_.reset();
                             if (!is_open()) return wake();
                             if (error) return lost();
                             out().written(bytes);
                             window_.sent(bytes);
                             if (window_.ping_due()) ping();
                             flush();
                           });
}

void WebSession::ping() {
  window_.ping_sent();
  ++operations_;
  stream_.async_ping({}, [this](const error_code& error) {
    --operations_;
    if (!is_open()) return wake();
    if (error && !saying_goodbye_) lost();
  });
}

void WebSession::written_out() {
  if (closing()) return begin_closing();
  proceed_if_due();
}

void WebSession::begin_closing() {
  saying_goodbye_ = true;
  goodbye_since_ = context().now;
  ++operations_;
  stream_.async_close(code_for(close_reason()), [this](const error_code&) {
    --operations_;
    hang_up();
  });
}

void WebSession::sweep() {
  if (!is_open()) return;
  check_deadlines();
  if (writing_since_ && over(*writing_since_, context().limits.stall_deadline)) return lost();
  const bool stuck = saying_goodbye_ ? over(goodbye_since_, kGoodbyeTime) : closing() && !accepted_;
  if (stuck) hang_up();
}

}  // namespace

std::unique_ptr<WireSession> make_web_session(SessionContext& context, SessionOwner& owner, std::uint64_t id,
                                              const asio::ip::tcp::endpoint& peer, UpgradePointer upgrade) {
  return std::make_unique<WebSession>(context, owner, id, peer, std::move(upgrade));
}

bool peer_of(const Upgrade& upgrade, asio::ip::tcp::endpoint& peer) {
  error_code error;
  peer = upgrade.stream.socket().remote_endpoint(error);
  return !error;
}

}  // namespace visum::protocol

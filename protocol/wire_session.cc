#include "protocol/wire_session.h"

#include <netinet/in.h>
#include <netinet/tcp.h>

#include <boost/asio/post.hpp>
#include <sstream>
#include <utility>

namespace visum::protocol {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

void set_option(int socket, int level, int name, int value) {
  ::setsockopt(socket, level, name, &value,
               sizeof value);  // an option that is refused leaves the kernel's default
}

}  // namespace

// A peer that vanished without a word is found by the kernel: idle within 4 s by probes, while sending by the
// timeout.
void set_socket_options(asio::ip::tcp::socket& socket) {
  error_code ignored;  // a socket that fails here fails again, and is seen, at the first read
  socket.non_blocking(true, ignored);
  const int handle = socket.native_handle();
  set_option(handle, IPPROTO_TCP, TCP_NODELAY, 1);
  set_option(handle, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(handle, IPPROTO_TCP, TCP_KEEPIDLE, 1);
  set_option(handle, IPPROTO_TCP, TCP_KEEPINTVL, 1);
  set_option(handle, IPPROTO_TCP, TCP_KEEPCNT, 3);
  set_option(handle, IPPROTO_TCP, TCP_USER_TIMEOUT, 4000);
}

std::string to_text(const asio::ip::tcp::endpoint& endpoint) {
  std::ostringstream text;
  text << endpoint;
  return text.str();
}

WireSession::WireSession(SessionContext& context, SessionOwner& owner, std::uint64_t id,
                         const asio::ip::tcp::endpoint& peer)
    : SessionCore(context, id, to_text(peer)), owner_(owner), address_(peer.address()) {}

void WireSession::wake() {
  if (!std::exchange(woken_, true)) owner_.woken(*this);
}

void WireSession::work() {
  // A transport may close its socket by itself (a WebSocket does after the closing handshake): nobody may
  // keep a session that is about to be freed.
  if (!is_open()) close(CloseReason::kLost);
  woken_ = false;
  tell_closed();
  flush();
}

void WireSession::proceed() {
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
  asio::post(socket().get_executor(), [this] {
    --operations_;
    turn_posted_ = false;
    if (!is_open()) return wake();
    proceed();
  });
}

void WireSession::proceed_if_due() {
  if (std::exchange(paused_, false)) proceed();
}

void WireSession::lost() {
  close(CloseReason::kLost);
  hang_up();
}

void WireSession::hang_up() {
  error_code ignored;
  socket().close(ignored);
  wake();
}

}  // namespace visum::protocol

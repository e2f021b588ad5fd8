#include "protocol/wire_session.h"

#include <boost/asio/post.hpp>
#include <new>
#include <sstream>
#include <utility>

#include "protocol/socket_options.h"

namespace visum::protocol {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

}  // namespace

void set_socket_options(asio::ip::tcp::socket& socket) {
  error_code ignored;  // a socket that fails here fails again at the first read, where it is noticed
  socket.non_blocking(true, ignored);
  set_tcp_options(socket.native_handle());
}

std::string to_text(const asio::ip::tcp::endpoint& endpoint) {
  std::ostringstream text;
  text << endpoint;
  return text.str();
}

asio::ip::address unmapped(const asio::ip::address& address) {
  if (!address.is_v6() || !address.to_v6().is_v4_mapped()) return address;
  return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6());
}

WireSession::WireSession(SessionContext& context, SessionOwner& owner, std::uint64_t id,
                         const asio::ip::address& address, const std::string& peer)
    : SessionCore(context, id, peer), owner_(owner), address_(address) {}

void WireSession::wake() {
  if (!std::exchange(woken_, true)) owner_.woken(*this);
}

void WireSession::work() {
  // A transport may close its socket by itself (a WebSocket does after the closing handshake). The handler
  // must be told before the session is freed.
  if (!is_open()) close(CloseReason::kLost);
  woken_ = false;
  end_hold();
  tell_closed();
  try {
    flush();
    if (tell_room()) proceed_if_due();
  } catch (const std::bad_alloc&) {  // for this session's bytes; the others are served
    lost();
  }
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
  asio::post(executor(), [this] {
    --operations_;
    turn_posted_ = false;
    if (!is_open()) return wake();
    proceed();
  });
}

// The handler's postponed requests come before requests that are not read yet: see work().
void WireSession::proceed_if_due() {
  if (owes_room()) return wake();
  if (std::exchange(paused_, false)) proceed();
}

void WireSession::lost() {
  close(CloseReason::kLost);
  hang_up();
}

void WireSession::hang_up() {
  close_socket();
  wake();
}

}  // namespace visum::protocol

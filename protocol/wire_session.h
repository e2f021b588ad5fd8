// A session with a transport below it. The server holds each client as one of these, whether its bytes come
// over a plain stream (stream_session.h) or in WebSocket messages (web_session.h). Owned by the server and
// used on its thread. Internal to the server, because it knows Asio.
#pragma once

#include <boost/asio/ip/tcp.hpp>

#include "protocol/session_core.h"
#include "protocol/talker.h"

namespace visum::protocol {

class WireSession;

// Collects the sessions that have something to do, for the end of the current event, and has places for them.
// The server is one.
class SessionOwner {
 public:
  virtual ~SessionOwner() = default;
  virtual void woken(WireSession& session) = 0;
  // The limit that stands against a session that says Hello with this role; "" if there is a place for it.
  virtual std::string refuse_place(const WireSession& session, Role role) const = 0;
  // True: the owner looks for what comes next to the session (Talker::takes()).
  virtual bool looks_after(WireSession& session) = 0;
};

class WireSession : public SessionCore, public Speaker {
 public:
  // The session must outlive its pending operations. Destroy it only when finished() is true, or when its
  // io_context runs no more handlers.
  // `peer` is the client's place as a text for logs.
  WireSession(SessionContext& context, SessionOwner& owner, std::uint64_t id,
              const boost::asio::ip::address& address, const std::string& peer);

  const boost::asio::ip::address& address() const { return address_; }

  virtual void start() = 0;   // begins to read
  void work();                // at the end of an event: tells the handler of a close, writes
  virtual void sweep() = 0;   // checks the deadlines
  virtual void let_go() = 0;  // closes at once, after writing what can be written without waiting
  bool is_woken() const { return woken_; }
  // True once the socket is closed and no operation holds a pointer to this session.
  bool finished() const { return !is_open() && operations_ == 0; }

 protected:
  virtual bool is_open() const = 0;  // the socket
  virtual void close_socket() = 0;
  virtual boost::asio::any_io_executor executor() = 0;
  virtual void read() = 0;

  void wake() override;
  std::string refuse_place(Role role) const override { return owner_.refuse_place(*this, role); }
  bool may_be_looked_after() { return owner_.looks_after(*this); }
  void proceed();         // handles the frames that have arrived, then reads on
  void proceed_if_due();  // continues reading that waited for writing
  bool paused() const { return paused_; }
  // Closes at once: the connection failed.
  void lost();
  // Closes the socket.
  void hang_up();

  int operations_ = 0;  // pending in the io_context; each holds a pointer to this

 private:
  SessionOwner& owner_;
  const boost::asio::ip::address address_;
  bool woken_ = false;  // is in the owner's list
  bool turn_posted_ = false;
  bool paused_ = false;  // reading waits for writing
};

// Makes the socket non-blocking and sets the options of socket_options.h.
void set_socket_options(boost::asio::ip::tcp::socket& socket);

// The address and port as text: "127.0.0.1:43210" or "[::1]:43210".
std::string to_text(const boost::asio::ip::tcp::endpoint& endpoint);
// A socket for both IPv4 and IPv6 calls 192.0.2.7 ::ffff:192.0.2.7. This turns it into the usual form.
boost::asio::ip::address unmapped(const boost::asio::ip::address& address);

}  // namespace visum::protocol

// A session with a transport below it: what the server keeps of every client, whether its bytes come over
// plain TCP (tcp_session.h) or in WebSocket messages (web_session.h). Internal to the server; knows Asio.
#pragma once

#include <boost/asio/ip/tcp.hpp>

#include "protocol/session_core.h"

namespace visum::protocol {

class WireSession;

// Who gathers the sessions that have something to do, for the end of the current event.
class SessionOwner {
 public:
  virtual ~SessionOwner() = default;
  virtual void woken(WireSession& session) = 0;
};

class WireSession : public SessionCore {
 public:
  using Socket = boost::asio::ip::tcp::socket;

  // The session must outlive its pending operations: destroy it when finished(), or when its io_context runs
  // no more handlers.
  WireSession(SessionContext& context, SessionOwner& owner, std::uint64_t id,
              const boost::asio::ip::tcp::endpoint& peer);

  const boost::asio::ip::address& address() const { return address_; }

  virtual void start() = 0;   // begins to read
  void work();                // at the end of an event: tells of a close, writes
  virtual void sweep() = 0;   // checks the deadlines
  virtual void let_go() = 0;  // writes what goes without waiting, and closes, now
  bool is_woken() const { return woken_; }
  bool finished() const { return !is_open() && operations_ == 0; }

 protected:
  virtual Socket& socket() = 0;
  virtual const Socket& socket() const = 0;
  virtual void read() = 0;

  bool is_open() const { return socket().is_open(); }
  void wake() override;
  void proceed();         // handles the frames that are there, then reads on
  void proceed_if_due();  // after writing: reading may have waited for it
  bool paused() const { return paused_; }
  void lost();
  void hang_up();

  int operations_ = 0;  // pending in the io_context, with a pointer to this

 private:
  SessionOwner& owner_;
  const boost::asio::ip::address address_;
  bool woken_ = false;  // stands in the owner's list
  bool turn_posted_ = false;
  bool paused_ = false;  // reading waits for writing
};

// No delay for small frames, and probes that find a silent peer (limits.h).
void set_socket_options(boost::asio::ip::tcp::socket& socket);

// The address and port as "127.0.0.1:43210" or "[::1]:43210".
std::string to_text(const boost::asio::ip::tcp::endpoint& endpoint);
// What a socket for both IPv4 and IPv6 calls ::ffff:192.0.2.7 is 192.0.2.7 to everybody else.
boost::asio::ip::address unmapped(const boost::asio::ip::address& address);

}  // namespace visum::protocol

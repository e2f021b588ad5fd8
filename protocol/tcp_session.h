// A session on its TCP socket: reads into the core, writes what it queued, lingers after a refusal so that
// the client can read why. Internal to the server (server.cc, tcp_session.cc): the only header here that
// knows Asio.
#pragma once

#include <boost/asio/ip/tcp.hpp>

#include "protocol/session_core.h"

namespace visum::protocol {

class TcpSession;

// Who gathers the sessions that have something to do, for the end of the current event.
class SessionOwner {
 public:
  virtual ~SessionOwner() = default;
  virtual void woken(TcpSession& session) = 0;
};

class TcpSession final : public SessionCore {
 public:
  using Socket = boost::asio::ip::tcp::socket;

  // `socket` is connected. The session must outlive its pending operations: destroy it when finished(), or
  // when its io_context runs no more handlers.
  TcpSession(SessionContext& context, SessionOwner& owner, Socket socket, std::uint64_t id,
             const boost::asio::ip::tcp::endpoint& peer);

  const boost::asio::ip::address& address() const { return address_; }

  void start();   // begins to read
  void work();    // at the end of an event: tells of a close, writes
  void sweep();   // checks the deadlines
  void let_go();  // writes what goes without waiting, and closes, now
  bool is_woken() const { return woken_; }
  bool finished() const { return !socket_.is_open() && operations_ == 0; }

 private:
  void wake() override;
  void flush() override;

  void read();
  void on_read(const boost::system::error_code& error, std::size_t bytes);
  void discard(std::size_t bytes);
  void proceed();
  void wait_until_writable();
  void written_out();
  void lost();
  void hang_up();

  SessionOwner& owner_;
  Socket socket_;
  const boost::asio::ip::address address_;
  int operations_ = 0;  // pending in the io_context, with a pointer to this
  bool woken_ = false;  // stands in the owner's list
  bool reading_ = false;
  bool turn_posted_ = false;
  bool paused_ = false;     // reading waits for writing
  bool blocked_ = false;    // writing waits for the peer
  bool peer_gone_ = false;  // its end of the stream was read
  bool lingering_ = false;  // all is written, our side is shut, the rest of the input is thrown away
  std::size_t discarded_ = 0;
  ServedTime blocked_since_{0};
  ServedTime lingering_since_{0};
};

// The address and port as "127.0.0.1:43210" or "[::1]:43210".
std::string to_text(const boost::asio::ip::tcp::endpoint& endpoint);

}  // namespace visum::protocol

// A session on its plain TCP socket: reads into the core, writes what it queued, lingers after a refusal so
// that the client can read why. Internal to the server.
#pragma once

#include "protocol/wire_session.h"

namespace visum::protocol {

class TcpSession final : public WireSession {
 public:
  TcpSession(SessionContext& context, SessionOwner& owner, Socket socket, std::uint64_t id,
             const boost::asio::ip::tcp::endpoint& peer);

  void start() override;
  void sweep() override;
  void let_go() override;

 private:
  Socket& socket() override { return socket_; }
  const Socket& socket() const override { return socket_; }
  void read() override;
  void flush() override;

  void on_read(const boost::system::error_code& error, std::size_t bytes);
  void discard(std::size_t bytes);
  void wait_until_writable();
  void written_out();

  Socket socket_;
  bool reading_ = false;
  bool blocked_ = false;    // writing waits for the peer
  bool peer_gone_ = false;  // its end of the stream was read
  bool lingering_ = false;  // all is written, our side is shut, the rest of the input is thrown away
  std::size_t discarded_ = 0;
  ServedTime blocked_since_{0};
  ServedTime lingering_since_{0};
};

}  // namespace visum::protocol

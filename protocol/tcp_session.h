// A session on its TCP socket, in plain text or over TLS: reads into the core, writes what it queued, lingers
// after a refusal so that the client can read why. Internal to the server.
#pragma once

#include <memory>
#include <vector>

#include "protocol/tls.h"
#include "protocol/wire_session.h"

namespace visum::protocol {

class TcpSession final : public WireSession {
 public:
  // `tls`: null for plain text.
  TcpSession(SessionContext& context, SessionOwner& owner, Socket socket, std::uint64_t id,
             const boost::asio::ip::tcp::endpoint& peer, const TlsContext* tls);

  std::string identity() const override;

  void start() override;
  void sweep() override;
  void let_go() override;

 private:
  Socket& socket() override { return socket_; }
  const Socket& socket() const override { return socket_; }
  void read() override;
  void flush() override;

  void on_read(const boost::system::error_code& error, std::size_t bytes);
  void take_plain();
  void decipher(std::size_t bytes);
  void tls_failed();
  void stream_ended();
  void discard(std::size_t bytes);
  std::span<std::byte> space_for_network();
  std::span<const std::byte> bytes_for_network();
  void wait_until_writable();
  void written_out();

  Socket socket_;
  std::unique_ptr<TlsStream> tls_;   // null: plain text
  std::vector<std::byte> ciphered_;  // as read from the network, where there is TLS
  bool fed_ = false;                 // bytes of TLS came
  bool fed_dry_ = true;              // nothing of them is left to be read
  bool said_goodbye_ = false;
  bool reading_ = false;
  bool blocked_ = false;    // writing waits for the peer
  bool peer_gone_ = false;  // its end of the stream was read
  bool lingering_ = false;  // all is written, our side is shut, the rest of the input is thrown away
  std::size_t discarded_ = 0;
  ServedTime blocked_since_{0};
  ServedTime lingering_since_{0};
};

}  // namespace visum::protocol

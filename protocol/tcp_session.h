// A session on its TCP socket, in plain text or over TLS. It reads into the core, writes what the core
// queued, and lingers after a refusal so that the client can read the reason. Lives on the server's thread,
// and the server owns it. A socket error or a missed deadline ends the session; nothing throws. Internal to
// the server.
#pragma once

#include <memory>
#include <vector>

#include "protocol/tls.h"
#include "protocol/wire_session.h"

namespace visum::protocol {

class TcpSession final : public WireSession {
 public:
  // `tls` is null for plain text. Otherwise it must outlive the session.
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
  // Feeds TLS with the bytes that were read. A client that speaks plain text is refused in plain text.
  void decipher(std::size_t bytes);
  // Moves deciphered bytes into the core, one record at a time, and handles the frames that they complete.
  void take_plain();
  // Logs and counts the failure, then ends the session.
  void tls_failed();
  // The peer has closed its side.
  void stream_ended();
  // Drops input that came while we linger, up to kMaxDiscarded bytes.
  void discard(std::size_t bytes);
  // The buffer for the next read: ciphered_, or the core's own buffer in plain text.
  std::span<std::byte> space_for_network();
  // The next bytes to write, ciphered if there is TLS. Empty when everything is written.
  std::span<const std::byte> bytes_for_network();
  // Calls flush() again when the socket takes more. sweep() ends the session if that takes too long.
  void wait_until_writable();
  // Everything is written: hangs up, lingers, or goes on reading.
  void written_out();
  // Starts to throw input away. sweep() hangs up after linger_bound().
  void linger();
  std::chrono::milliseconds linger_bound();

  Socket socket_;
  std::unique_ptr<TlsStream> tls_;   // null: plain text
  std::vector<std::byte> ciphered_;  // as read from the network, if there is TLS
  bool fed_ = false;                 // bytes of TLS came
  bool fed_dry_ = true;              // all of them have been deciphered
  bool said_goodbye_ = false;
  bool handshake_failed_ = false;
  bool reading_ = false;
  bool blocked_ = false;       // writing waits for the peer
  bool peer_gone_ = false;     // its end of the stream was read
  bool lingering_ = false;     // everything is written, and input is thrown away
  std::size_t discarded_ = 0;  // bytes
  ServedTime blocked_since_{0};
  ServedTime lingering_since_{0};
};

}  // namespace visum::protocol

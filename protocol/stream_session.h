// A session on its socket: TCP, in plain text or over TLS, or a Unix socket. It reads into the core, writes
// what the core queued, and lingers after a refusal so that the client can read the reason. Lives on the
// server's thread, and the server owns it. A socket error or a missed deadline ends the session; nothing
// throws. Internal to the server.
#pragma once

#include <boost/asio/generic/stream_protocol.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <memory>
#include <vector>

#include "protocol/tls.h"
#include "protocol/wire_session.h"

namespace visum::protocol {

class StreamSession final : public WireSession {
 public:
  using Socket = boost::asio::generic::stream_protocol::socket;

  // `tls` is null for plain text. Otherwise it must outlive the session.
  StreamSession(SessionContext& context, SessionOwner& owner, boost::asio::ip::tcp::socket socket,
                std::uint64_t id, const boost::asio::ip::tcp::endpoint& peer, const TlsContext* tls);
  // A program on this machine, which counts as one that came from 127.0.0.1.
  StreamSession(SessionContext& context, SessionOwner& owner,
                boost::asio::local::stream_protocol::socket socket, std::uint64_t id);

  std::string identity() const override;

  void start() override;
  void sweep() override;
  void let_go() override;
  bool is_looked_after() const override { return looked_after_; }
  bool take_now() override;
  void wait_for_bytes() override;

 private:
  StreamSession(SessionContext& context, SessionOwner& owner, Socket socket, std::uint64_t id,
                const boost::asio::ip::address& address, const std::string& peer);

  bool is_open() const override { return socket_.is_open(); }
  void close_socket() override;
  boost::asio::any_io_executor executor() override { return socket_.get_executor(); }
  void read() override;
  void flush() override;

  void wait_to_read();
  // `space`: how many bytes there could have been.
  void on_read(const boost::system::error_code& error, std::size_t bytes, std::size_t space);
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
  bool reading_ = false;       // waits in the io_context
  bool looked_after_ = false;  // the owner calls take_now()
  bool drained_ = false;       // by the last read, as far as one can tell
  bool blocked_ = false;       // writing waits for the peer
  bool peer_gone_ = false;     // its end of the stream was read
  bool lingering_ = false;     // everything is written, and input is thrown away
  std::size_t discarded_ = 0;  // bytes
  ServedTime blocked_since_{0};
  ServedTime lingering_since_{0};
};

}  // namespace visum::protocol

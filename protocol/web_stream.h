// A connection of the HTTP port as a stream for Asio and Beast: a TCP socket, in plain text or over TLS. It
// belongs to an HttpConnection or a WebSession, and lives on the thread of the socket's io_context. Errors
// reach the handlers of reads and writes; nothing throws. Internal to http_connection.cc and web_session.cc.
#pragma once

#include <boost/asio/async_result.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/role.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "protocol/tls.h"

namespace visum::protocol {

class WebStream {
 public:
  using Socket = boost::asio::ip::tcp::socket;
  using executor_type = Socket::executor_type;
  using error_code = boost::system::error_code;

  // `tls` is null for plain text. Otherwise it must outlive the stream. The first read makes the handshake.
  WebStream(Socket socket, const TlsContext* tls);
  ~WebStream();
  WebStream(WebStream&&) noexcept;  // only while no operation is pending; the old stream is then closed
  WebStream& operator=(WebStream&&) = delete;

  bool is_open() const;
  bool is_tls() const;
  Socket& socket();
  const Socket& socket() const;
  executor_type get_executor() { return socket().get_executor(); }

  std::string identity() const;  // the name in the peer's certificate; empty without a certificate
  std::string failure() const;   // why TLS with the peer failed; empty if it did not, or in plain text
  // The peer spoke plain text to a port that speaks TLS. The read has failed, and writes go out in plain
  // text.
  bool spoke_plain_text() const;

  void finish();  // ends the TLS stream, if there is one; nothing may be written after it
  void close();

  // The operations that Asio's AsyncReadStream and AsyncWriteStream ask for. One read and one write at a
  // time.
  template <typename Buffers, typename Token>
  auto async_read_some(const Buffers& buffers, Token&& token) {
    return boost::asio::async_initiate<Token, void(error_code, std::size_t)>(
        [this](auto handler, const Buffers& into) {
          if (!is_tls()) return socket().async_read_some(into, std::move(handler));
          read(first_of(into), shared(std::move(handler)));
        },
        token, buffers);
  }
  template <typename Buffers, typename Token>
  auto async_write_some(const Buffers& buffers, Token&& token) {
    return boost::asio::async_initiate<Token, void(error_code, std::size_t)>(
        [this](auto handler, const Buffers& from) {
          if (!is_tls()) return socket().async_write_some(from, std::move(handler));
          std::size_t taken = 0;
          for (auto it = boost::asio::buffer_sequence_begin(from);
               it != boost::asio::buffer_sequence_end(from) && encipher(*it, taken); ++it) {
          }
          deliver(taken, shared(std::move(handler)));
        },
        token, buffers);
  }

 private:
  struct Impl;
  using Done = std::function<void(const error_code&, std::size_t)>;

  // Makes a handler copyable: Beast's handlers can only be moved.
  template <typename Handler>
  static Done shared(Handler handler) {
    return [kept = std::make_shared<Handler>(std::move(handler))](
               const error_code& error, std::size_t bytes) { (*kept)(error, bytes); };
  }
  template <typename Buffers>
  static boost::asio::mutable_buffer first_of(const Buffers& buffers) {
    for (auto it = boost::asio::buffer_sequence_begin(buffers);
         it != boost::asio::buffer_sequence_end(buffers); ++it)
      if (boost::asio::mutable_buffer(*it).size() > 0) return *it;
    return {};
  }
  void read(boost::asio::mutable_buffer into, Done done);
  // Ciphers bytes, and adds their number to `taken`. False: enough is ciphered for one write.
  bool encipher(boost::asio::const_buffer from, std::size_t& taken);
  // Sends the ciphered bytes, then reports `taken` plain bytes as written.
  void deliver(std::size_t taken, Done done);

  std::shared_ptr<Impl> impl_;  // pending operations keep it
};

// Beast calls these two to end the connection under a WebSocket.
template <typename Handler>
void async_teardown(boost::beast::role_type role, WebStream& stream, Handler&& handler) {
  stream.finish();
  boost::beast::websocket::async_teardown(role, stream.socket(), std::forward<Handler>(handler));
}
void beast_close_socket(WebStream& stream);

}  // namespace visum::protocol

// A connection of the HTTP port as Asio and Beast read and write one: a TCP socket, in plain text or over
// TLS. Internal to http_connection.cc and web_session.cc. One thread, that of the socket's io_context.
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

  // `tls`: null for plain text; it must outlive the stream. The handshake is made by the first read.
  WebStream(Socket socket, const TlsContext* tls);
  ~WebStream();
  WebStream(WebStream&&) noexcept;  // while nothing pends; what is moved from is closed
  WebStream& operator=(WebStream&&) = delete;

  bool is_open() const;
  bool is_tls() const;
  Socket& socket();
  const Socket& socket() const;
  executor_type get_executor() { return socket().get_executor(); }

  std::string identity() const;  // the name in the certificate that the peer showed; "": it showed none
  std::string failure() const;   // why there is no TLS with the peer; "": there is, or none is wanted
  // The peer spoke plain text where TLS is spoken: read() has failed, and plain text is what it may be told.
  bool spoke_plain_text() const;

  void finish();  // says goodbye where there is TLS; nothing may be written after it
  void close();

  // As AsyncReadStream and AsyncWriteStream of Asio ask for: one read and one write at a time.
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

  // Handlers of Beast can be moved only.
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
  // Adds to `taken`; false: no more should be taken at once.
  bool encipher(boost::asio::const_buffer from, std::size_t& taken);
  void deliver(std::size_t taken, Done done);

  std::shared_ptr<Impl> impl_;  // pending operations keep it
};

// What Beast calls to end a connection under a WebSocket.
template <typename Handler>
void async_teardown(boost::beast::role_type role, WebStream& stream, Handler&& handler) {
  stream.finish();
  boost::beast::websocket::async_teardown(role, stream.socket(), std::forward<Handler>(handler));
}
void beast_close_socket(WebStream& stream);

}  // namespace visum::protocol

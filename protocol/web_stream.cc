#include "protocol/web_stream.h"

#include <algorithm>
#include <boost/asio/error.hpp>
#include <boost/asio/post.hpp>
#include <vector>

namespace visum::protocol {
namespace {

namespace asio = boost::asio;
using boost::system::error_code;

constexpr std::size_t kWebCipheredBytes = 16u << 10;  // about a record of TLS

}  // namespace

struct WebStream::Impl : std::enable_shared_from_this<WebStream::Impl> {
  Impl(Socket the_socket, const TlsContext* context) : socket(std::move(the_socket)) {
    if (!context) return;
    tls = std::make_unique<TlsStream>(*context);
    ciphered.resize(kWebCipheredBytes);
  }

  void read(std::span<std::byte> into, Done done);
  void on_read(const error_code& error, std::size_t bytes, std::span<std::byte> into, Done done);
  void deliver(std::size_t taken, Done done);
  void flush();
  void flushed(const error_code& error);
  void post(Done done, const error_code& error, std::size_t bytes);

  Socket socket;
  std::unique_ptr<TlsStream> tls;  // null: plain text
  std::vector<std::byte> ciphered;
  bool fed = false;  // bytes of TLS came
  bool spoke_plain_text = false;
  bool blocked = false;  // writing waits for the peer
  Done on_delivered;     // the handler of the write that waits for the network
  std::size_t taken_bytes = 0;
};

// Calls a handler later: Asio demands that no handler runs within the call that began the operation.
void WebStream::Impl::post(Done done, const error_code& error, std::size_t bytes) {
  asio::post(socket.get_executor(), [done = std::move(done), error, bytes] { done(error, bytes); });
}

void WebStream::Impl::read(std::span<std::byte> into, Done done) {
  const std::size_t got = tls->read(into);
  flush();  // a handshake may have something to send, and so may a refusal
  if (got > 0 || into.empty()) return post(std::move(done), {}, got);
  if (!tls->failure().empty()) return post(std::move(done), asio::error::access_denied, 0);
  if (tls->ended()) return post(std::move(done), asio::error::eof, 0);
  socket.async_read_some(asio::buffer(ciphered), [self = shared_from_this(), into, done = std::move(done)](
                                                     const error_code& error, std::size_t bytes) {
    self->on_read(error, bytes, into, done);
  });
}

void WebStream::Impl::on_read(const error_code& error, std::size_t bytes, std::span<std::byte> into,
                              Done done) {
  if (error) return done(error, 0);
  const auto fresh = std::span<const std::byte>(ciphered).first(bytes);
  if (!fed && !looks_like_tls(fresh)) {
    spoke_plain_text = true;
    tls.reset();
    return done(asio::error::no_protocol_option, 0);
  }
  fed = true;
  tls->feed(fresh);
  read(into, std::move(done));
}

void WebStream::Impl::deliver(std::size_t taken, Done done) {
  if (taken == 0) return post(std::move(done), asio::error::broken_pipe, 0);
  taken_bytes = taken;
  on_delivered = std::move(done);
  flush();
}

// Writes what is pending, until the socket takes no more; then again when it takes more.
void WebStream::Impl::flush() {
  if (blocked || !tls) return;
  for (auto bytes = tls->pending(); !bytes.empty(); bytes = tls->pending()) {
    error_code error;
    const std::size_t sent = socket.write_some(asio::buffer(bytes.data(), bytes.size()), error);
    if (error == asio::error::would_block) {
      blocked = true;
      return socket.async_wait(Socket::wait_write, [self = shared_from_this()](const error_code& failed) {
        self->blocked = false;
        failed ? self->flushed(failed) : self->flush();
      });
    }
    if (error) return flushed(error);
    tls->sent(sent);
  }
  flushed({});
}

void WebStream::Impl::flushed(const error_code& error) {
  if (on_delivered) post(std::exchange(on_delivered, nullptr), error, error ? 0 : taken_bytes);
}

WebStream::WebStream(Socket socket, const TlsContext* tls)
    : impl_(std::make_shared<Impl>(std::move(socket), tls)) {}

WebStream::~WebStream() {
  close();
}

WebStream::WebStream(WebStream&&) noexcept = default;

bool WebStream::is_open() const {
  return impl_ && impl_->socket.is_open();
}

bool WebStream::is_tls() const {
  return impl_->tls != nullptr;
}

WebStream::Socket& WebStream::socket() {
  return impl_->socket;
}

const WebStream::Socket& WebStream::socket() const {
  return impl_->socket;
}

std::string WebStream::identity() const {
  return is_tls() ? impl_->tls->peer_name() : std::string();
}

std::string WebStream::failure() const {
  return is_tls() ? impl_->tls->failure() : std::string();
}

bool WebStream::spoke_plain_text() const {
  return impl_->spoke_plain_text;
}

void WebStream::finish() {
  if (!is_open() || !is_tls()) return;
  impl_->tls->finish();
  impl_->flush();
}

void WebStream::close() {
  error_code ignored;
  if (impl_) impl_->socket.close(ignored);
}

void WebStream::read(asio::mutable_buffer into, Done done) {
  impl_->read({static_cast<std::byte*>(into.data()), into.size()}, std::move(done));
}

bool WebStream::encipher(asio::const_buffer from, std::size_t& taken) {
  const std::size_t most = std::min(from.size(), kWebCipheredBytes - taken);
  const std::size_t bytes = impl_->tls->write({static_cast<const std::byte*>(from.data()), most});
  taken += bytes;
  return bytes == from.size() && taken < kWebCipheredBytes;
}

void WebStream::deliver(std::size_t taken, Done done) {
  impl_->deliver(taken, std::move(done));
}

void beast_close_socket(WebStream& stream) {
  stream.close();
}

}  // namespace visum::protocol

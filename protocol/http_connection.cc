#include "protocol/http_connection.h"

#include <array>
#include <boost/asio/buffer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/rfc7230.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <optional>
#include <sstream>
#include <utility>

#include "protocol/web_upgrade.h"
#include "protocol/wire_session.h"

namespace visum::protocol {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using boost::system::error_code;
using HttpRequest = http::request<http::empty_body>;

constexpr std::uint32_t kMaxHeadBytes = 8u << 10;
constexpr std::chrono::milliseconds kIdle{15'000};     // from an answer to the next request
constexpr std::chrono::milliseconds kHttpLinger{500};  // for the peer to read why it is refused
constexpr std::size_t kMaxHttpDiscarded = 1u << 20;
constexpr char kPlainText[] =
    "this server speaks TLS only: ask for https://, and show a certificate of its authority\n";

std::string text_of(beast::string_view text) {
  return {text.data(), text.size()};
}

std::vector<std::string> values_of(const HttpRequest& request, http::field field) {
  std::vector<std::string> values;
  const auto range = request.equal_range(field);
  for (auto it = range.first; it != range.second; ++it) values.push_back(text_of(it->value()));
  return values;
}

bool takes_gzip(const HttpRequest& request) {
  return http::token_list(request[http::field::accept_encoding]).exists("gzip");
}

std::string bearer_of(const HttpRequest& request) {
  const std::string value = text_of(request[http::field::authorization]);
  return value.starts_with("Bearer ") ? value.substr(7) : std::string();
}

HttpHead head_of(const HttpRequest& request, const asio::ip::tcp::socket& socket) {
  error_code ignored;
  HttpHead head;
  head.method = text_of(request.method_string());
  head.target = text_of(request.target());
  head.hosts = values_of(request, http::field::host);
  head.origins = values_of(request, http::field::origin);
  head.local_address = unmapped(socket.local_endpoint(ignored).address()).to_string();
  const bool empty =
      request[http::field::content_length].empty() || request[http::field::content_length] == "0";
  head.has_body = !empty || request.count(http::field::transfer_encoding) > 0;
  head.wants_upgrade = request.count(http::field::upgrade) > 0;
  head.is_websocket = beast::websocket::is_upgrade(request);
  for (const auto& token : http::token_list(request[http::field::sec_websocket_protocol]))
    head.subprotocols.push_back(text_of(token));
  return head;
}

// The headers of every answer: no site may put the page into a frame, and browsers may neither guess content
// types nor load anything from elsewhere.
void set_security(http::response<http::empty_body>& response) {
  response.set("Content-Security-Policy",
               "default-src 'self'; img-src 'self' blob:; object-src 'none'; base-uri 'none'; "
               "form-action 'none'; frame-ancestors 'none'");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
}

std::string head_text(const WebReply& reply, std::size_t length, bool keep_alive) {
  http::response<http::empty_body> response(static_cast<http::status>(reply.status), 11);
  set_security(response);
  response.set(http::field::content_type, reply.content_type);
  if (reply.gzip) response.set(http::field::content_encoding, "gzip");
  response.set(http::field::vary, "Accept-Encoding");
  if (!reply.etag.empty()) response.set(http::field::etag, reply.etag);
  response.set(http::field::cache_control,
               reply.immutable ? "public, max-age=31536000, immutable" : "no-cache");
  if (reply.status == 405) response.set(http::field::allow, "GET, HEAD");
  if (reply.status == 426) response.set(http::field::upgrade, "websocket");
  if (reply.status == 401) response.set(http::field::www_authenticate, "Bearer");
  response.keep_alive(keep_alive);
  if (reply.status != 304) response.content_length(length);
  std::ostringstream text;
  text << response.base();
  return text.str();
}

}  // namespace

struct HttpConnection::Impl {
  Impl(Listener::Socket the_socket, const asio::ip::tcp::endpoint& the_peer, const TlsContext* tls,
       const HttpRules& the_rules, WebPages& the_pages, SessionContext& the_context, HttpOwner& the_owner)
      : stream(std::move(the_socket), tls),
        rules(the_rules),
        pages(the_pages),
        context(the_context),
        owner(the_owner),
        address(the_peer.address()),
        since(context.now) {
    set_socket_options(stream.socket());
  }

  void read();
  void on_read(const error_code& error);
  // Logs and counts the failure. A client that spoke plain HTTP gets an answer in plain text.
  void tls_failed();
  // Judges the request by the rules, then asks the pages.
  void answer(const HttpRequest& request);
  // Gives the socket to the server, which makes a WebSocket session of it.
  void hand_on();
  // `keep`: the connection stays open for another request.
  void send(WebReply answer_to_send, bool keep, bool with_body);
  void write();
  // Ends our side of the stream, then throws input away until the peer closes.
  void linger();
  void discard();
  bool has_begun() const { return parser->got_some() || buffer.size() > 0; }  // to send a request
  bool is_idle() const { return was_answered && !writing && !lingering && !has_begun(); }
  // True if the peer has used up the time for its present step.
  bool is_late();

  WebStream stream;
  const HttpRules& rules;
  WebPages& pages;
  SessionContext& context;
  HttpOwner& owner;
  const asio::ip::address address;
  beast::flat_buffer buffer{kMaxHeadBytes};
  std::optional<http::request_parser<http::empty_body>> parser;
  WebReply reply;
  std::string head;
  std::array<asio::const_buffer, 2> unsent{};
  bool keep_alive = false;
  bool writing = false;
  bool was_answered = false;
  bool handshake_failed = false;
  bool head_began = false;    // the first byte of the next request has come
  bool lingering = false;     // everything is written, and input is thrown away
  std::size_t discarded = 0;  // bytes
  ServedTime since;           // when the present wait for the peer began, or made progress
  int operations = 0;         // pending in the io_context, with a pointer to this
};

void HttpConnection::Impl::read() {
  parser.emplace();
  head_began = false;
  parser->header_limit(kMaxHeadBytes);
  since = context.now;
  ++operations;
  http::async_read_header(stream, buffer, *parser, [this](const error_code& error, std::size_t) {
    --operations;
    on_read(error);
  });
}

void HttpConnection::Impl::on_read(const error_code& error) {
  if (!stream.is_open()) return;
  if (stream.spoke_plain_text() || !stream.failure().empty()) return tls_failed();
  if (error == http::error::end_of_stream || error == asio::error::eof) return stream.close();
  if (error.category() == http::make_error_code(http::error::bad_method).category()) {
    context.refused.fetch_add(1, std::memory_order_relaxed);
    const int status =
        error == http::error::header_limit || error == http::error::buffer_overflow ? 431 : 400;
    return send({status, "text/plain; charset=utf-8", "this is not a request: " + error.message() + "\n"},
                false, true);
  }
  if (error) return stream.close();
  answer(parser->get());
}

void HttpConnection::Impl::tls_failed() {
  error_code gone;
  const auto peer = to_text(stream.socket().remote_endpoint(gone));
  const bool plain = stream.spoke_plain_text();
  context.address_logs.of(peer).write(
      LogLevel::kWarning,
      peer + " is refused: " + (plain ? "plain HTTP, where https is spoken" : stream.failure()));
  context.refused.fetch_add(1, std::memory_order_relaxed);
  if (plain) return send({400, "text/plain; charset=utf-8", kPlainText}, false, true);
  // The stream has sent the alert. Our side stays open until the peer closes or the time is up: Chromium
  // forgets the alert, and reports that it is not connected, if it finds the connection ended before its
  // request.
  handshake_failed = lingering = true;
  since = context.now;
  discard();
}

void HttpConnection::Impl::answer(const HttpRequest& request) {
  const HttpHead asked = head_of(request, stream.socket());
  HttpVerdict verdict = rules.judge(asked);
  if (verdict.status == 101 && buffer.size() > 0)
    verdict = {400, "no data may follow before the handshake is answered"};
  if (verdict.status == 101) return hand_on();
  const bool with_body = request.method() != http::verb::head;
  if (verdict.status != 200) {
    context.refused.fetch_add(1, std::memory_order_relaxed);
    return send({verdict.status, "text/plain; charset=utf-8", verdict.reason + "\n"}, false, with_body);
  }
  send(pages.get({path_of(asked.target), takes_gzip(request), text_of(request[http::field::if_none_match]),
                  bearer_of(request), stream.identity()}),
       request.keep_alive(), with_body);
}

void HttpConnection::Impl::hand_on() {
  owner.upgraded(UpgradePointer(new Upgrade{std::move(stream), parser->release()}));
}

void HttpConnection::Impl::send(WebReply answer_to_send, bool keep, bool with_body) {
  reply = std::move(answer_to_send);
  keep_alive = keep;
  const std::string_view body = reply.text.empty() ? reply.fixed : std::string_view(reply.text);
  head = head_text(reply, body.size(), keep_alive);
  unsent = {asio::buffer(head), with_body ? asio::buffer(body.data(), body.size()) : asio::const_buffer()};
  writing = true;
  since = context.now;
  write();
}

// Writes one piece after the other. Each piece restarts the deadline: a slow peer may take its time for a
// large answer, and a peer that stops reading is closed.
void HttpConnection::Impl::write() {
  ++operations;
  stream.async_write_some(unsent, [this](const error_code& error, std::size_t bytes) {
    --operations;
    if (!stream.is_open()) return;
    if (error) return stream.close();
    since = context.now;
    for (auto& piece : unsent) {
      const std::size_t of_piece = std::min(bytes, piece.size());
      piece += of_piece;
      bytes -= of_piece;
    }
    if (unsent[0].size() + unsent[1].size() > 0) return write();
    writing = false;
    was_answered = true;
    keep_alive ? read() : linger();
  });
}

// Closing with unread input would reset the connection, and the reset may overtake what was sent last.
void HttpConnection::Impl::linger() {
  stream.finish();
  error_code ignored;
  stream.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  lingering = true;
  since = context.now;
  discard();
}

void HttpConnection::Impl::discard() {
  ++operations;
  buffer.clear();
  stream.socket().async_read_some(buffer.prepare(kMaxHeadBytes),
                                  [this](const error_code& error, std::size_t bytes) {
                                    --operations;
                                    discarded += bytes;
                                    if (!stream.is_open()) return;
                                    if (error || discarded > kMaxHttpDiscarded) return stream.close();
                                    discard();
                                  });
}

bool HttpConnection::Impl::is_late() {
  const auto& limits = context.limits;
  const auto is_over = [this](std::chrono::milliseconds deadline) {
    return context.now - since > deadline + context.step;
  };
  // A refused TLS client gets as long as one that says nothing at all.
  if (lingering) return is_over(handshake_failed ? limits.hello_deadline : kHttpLinger);
  if (writing) return is_over(limits.stall_deadline);
  // The first request must come as soon as a Hello must. Further ones may take their time, but once one has
  // begun, its head must come soon.
  if (!was_answered) return is_over(limits.hello_deadline);
  if (!head_began && has_begun()) {
    head_began = true;
    since = context.now;
  }
  return is_over(head_began ? limits.http_head_deadline : kIdle);
}

HttpConnection::HttpConnection(Listener::Socket socket, const asio::ip::tcp::endpoint& peer,
                               const TlsContext* tls, const HttpRules& rules, WebPages& pages,
                               SessionContext& context, HttpOwner& owner)
    : impl_(std::make_unique<Impl>(std::move(socket), peer, tls, rules, pages, context, owner)) {}

HttpConnection::~HttpConnection() = default;

void HttpConnection::start() {
  impl_->read();
}

void HttpConnection::sweep() {
  if (impl_->stream.is_open() && impl_->is_late()) impl_->stream.close();
}

void HttpConnection::close() {
  impl_->stream.close();
}

bool HttpConnection::is_open() const {
  return impl_->stream.is_open();
}

bool HttpConnection::is_idle() const {
  return impl_->is_idle();
}

ServedTime HttpConnection::since() const {
  return impl_->since;
}

const asio::ip::address& HttpConnection::address() const {
  return impl_->address;
}

bool HttpConnection::finished() const {
  return !impl_->stream.is_open() && impl_->operations == 0;
}

void UpgradeDeleter::operator()(Upgrade* upgrade) const {
  delete upgrade;
}

}  // namespace visum::protocol

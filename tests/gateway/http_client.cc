#include "tests/gateway/http_client.h"

#include <algorithm>
#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <cctype>
#include <stdexcept>

#include "protocol/web_pages.h"

namespace visum::testing {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;

tcp::endpoint endpoint_of(std::uint16_t port) {
  return {asio::ip::address_v4::loopback(), port};
}

std::string host_of(std::uint16_t port) {
  return "127.0.0.1:" + std::to_string(port);
}

std::string in_lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

// A blocking socket that counts the bytes that it reads.
class CountingSocket {
 public:
  using executor_type = tcp::socket::executor_type;

  explicit CountingSocket(asio::io_context& io) : socket_(io) {}
  tcp::socket& socket() { return socket_; }
  executor_type get_executor() { return socket_.get_executor(); }
  std::uint64_t received() const { return received_; }

  template <typename Buffers>
  std::size_t read_some(const Buffers& into, boost::system::error_code& error) {
    const std::size_t bytes = socket_.read_some(into, error);
    received_ += bytes;
    return bytes;
  }
  template <typename Buffers>
  std::size_t write_some(const Buffers& from, boost::system::error_code& error) {
    return socket_.write_some(from, error);
  }
  // Beast asks for these two as well.
  template <typename Buffers>
  std::size_t read_some(const Buffers& into) {
    const std::size_t bytes = socket_.read_some(into);
    received_ += bytes;
    return bytes;
  }
  template <typename Buffers>
  std::size_t write_some(const Buffers& from) {
    return socket_.write_some(from);
  }

 private:
  tcp::socket socket_;
  std::uint64_t received_ = 0;
};

// Beast calls it to end the connection under a WebSocket.
void teardown(beast::role_type role, CountingSocket& stream, boost::system::error_code& error) {
  websocket::teardown(role, stream.socket(), error);
}

}  // namespace

HttpAnswer http_request(std::uint16_t port, const std::string& method, const std::string& target,
                        const std::map<std::string, std::string>& fields, const std::string& address) {
  asio::io_context io;
  tcp::socket socket(io);
  socket.connect({asio::ip::make_address(address), port});
  http::request<http::empty_body> request;
  request.method_string(method);
  request.target(target);
  request.set(http::field::host, address + ":" + std::to_string(port));
  request.set(http::field::connection, "close");
  for (const auto& [name, value] : fields) request.set(name, value);
  http::write(socket, request);

  beast::flat_buffer buffer;
  http::response_parser<http::string_body> parser;
  parser.skip(method == "HEAD");
  http::read(socket, buffer, parser);
  HttpAnswer answer{static_cast<int>(parser.get().result_int()), {}, parser.get().body()};
  for (const auto& field : parser.get())
    answer.fields[in_lower_case(std::string(field.name_string()))] = std::string(field.value());
  return answer;
}

struct WebClient::Impl {
  asio::io_context io;
  websocket::stream<CountingSocket> stream{io};
  beast::flat_buffer received;
  std::uint64_t received_bytes = 0, longest_message = 0;
};

WebClient::WebClient(std::uint16_t port, const std::string& origin, bool compresses)
    : impl_(std::make_unique<Impl>()) {
  impl_->stream.next_layer().socket().connect(endpoint_of(port));
  websocket::permessage_deflate deflate;
  deflate.client_enable = compresses;
  impl_->stream.set_option(deflate);
  impl_->stream.binary(true);
  impl_->stream.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
    request.set(http::field::origin, origin.empty() ? "http://" + host_of(port) : origin);
    request.set(http::field::sec_websocket_protocol, std::string(protocol::kWebSocketProtocol));
  }));
  impl_->stream.handshake(host_of(port), std::string(protocol::kWebSocketPath));
}

WebClient::~WebClient() = default;

void WebClient::send(std::uint64_t id, const protocol::Request& request) {
  std::vector<std::byte> frame;
  protocol::encode_request(id, request, frame);
  impl_->stream.write(asio::buffer(frame));
}

void WebClient::send_text(const std::string& text) {
  impl_->stream.text(true);
  impl_->stream.write(asio::buffer(text));
}

void WebClient::send_bytes(std::span<const std::byte> bytes) {
  boost::system::error_code ignored;
  impl_->stream.write(asio::buffer(bytes.data(), bytes.size()), ignored);
}

// Messages may hold several frames, or parts of one.
protocol::ReplyFrame WebClient::next() {
  auto& received = impl_->received;
  const auto bytes = [&] { return static_cast<const std::byte*>(received.cdata().data()); };
  for (;;) {
    if (received.size() >= protocol::kHeaderBytes) {
      const std::size_t length = protocol::frame_length(std::span<const std::byte, 4>(bytes(), 4));
      if (received.size() >= protocol::kHeaderBytes + length) {
        std::string why;
        auto frame = protocol::decode_reply({bytes() + protocol::kHeaderBytes, length}, why);
        if (!frame) throw std::runtime_error("the server sent what is no reply: " + why);
        received.consume(protocol::kHeaderBytes + length);
        return std::move(*frame);
      }
    }
    const std::uint64_t message = impl_->stream.read(received);
    impl_->received_bytes += message;
    impl_->longest_message = std::max(impl_->longest_message, message);
  }
}

void WebClient::say_goodbye() {
  impl_->stream.close(websocket::close_code::going_away);
}

std::uint64_t WebClient::received_bytes() const {
  return impl_->received_bytes;
}

std::uint64_t WebClient::wire_bytes() const {
  return impl_->stream.next_layer().received();
}

std::uint64_t WebClient::longest_message() const {
  return impl_->longest_message;
}

int WebClient::closing_code() {
  boost::system::error_code error;
  while (!error) impl_->stream.read(impl_->received, error);
  return error == websocket::error::closed ? impl_->stream.reason().code : 0;
}

}  // namespace visum::testing

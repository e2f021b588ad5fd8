#include "protocol/client.h"

#include <charconv>
#include <vector>

#include "protocol/client_inbox.h"
#include "protocol/client_socket.h"
#include "protocol/codec.h"
#include "protocol/frame_buffer.h"
#include "protocol/limits.h"

namespace visum::protocol {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t kReceiveBytes = 16u << 10;

bool waits_for_the_world(const Request& request) {
  return std::holds_alternative<Advance>(request) || std::holds_alternative<Step>(request) ||
         std::holds_alternative<LoadScene>(request);
}

}  // namespace

struct Connection::Impl {
  Impl(const std::string& host, std::uint16_t port, milliseconds timeout, const TlsFiles& tls)
      : timeout_(timeout),
        socket_(host, port, tls, steady_clock::now() + timeout),
        in_(kReceiveBytes, kReceiveBytes) {}
  ~Impl();

  void say_hello(const Hello& hello, Deadline deadline);
  std::uint64_t encode(const Request& request);  // queues one more request in flight; returns its id
  void flush();                                  // sends what encode() queued
  // Waits for bytes and files the frames in them.
  bool receive(Deadline deadline);   // false: the deadline passed
  bool taken(std::size_t received);  // files what was received; true if that was anything
  // After a read over TLS: reads all that is there.
  void drain();
  template <typename Call>
  // Runs `call`; adds the server's last words to a ConnectionError.
  std::size_t explained(Call call);
  void read_frames();
  std::optional<Reply> wait_for(std::uint64_t id, Deadline deadline);  // nothing: the deadline passed
  Reply wait(std::uint64_t id, Deadline deadline);
  Deadline deadline_of(std::uint64_t id);

  const milliseconds timeout_;
  ClientSocket socket_;
  FrameBuffer in_;
  std::vector<std::byte> out_, leaving_;
  ClientInbox inbox_;
  Welcome welcome_;
  std::uint64_t last_id_ = 0;
};

// ---------------------------------------- bytes

std::uint64_t Connection::Impl::encode(const Request& request) {
  const std::uint64_t id = ++last_id_;
  inbox_.expect(id, waits_for_the_world(request));
  encode_request(id, request, out_);
  return id;
}

// Hands what still waits to the socket, as far as the socket takes it at once.
Connection::Impl::~Impl() {
  try {
    if (!out_.empty()) socket_.send(out_);
  } catch (const std::runtime_error&) {
    // The connection is gone, and the waiting requests with it.
  }
  socket_.finish();
}

// Sends all that waits. A server that is slow to read may itself be waiting for us to read, so this reads
// too. After a failure nothing is sent again, because some of it may have left.
void Connection::Impl::flush() {
  leaving_.clear();
  leaving_.swap(out_);
  std::span<const std::byte> left(leaving_);
  while (!left.empty() || socket_.has_unsent()) {
    const std::size_t sent = explained([&] { return socket_.send(left); });
    left = left.subspan(sent);
    if (sent > 0 || (left.empty() && !socket_.has_unsent())) continue;
    if (!socket_.wait_to_send(steady_clock::now() + timeout_))
      throw ConnectionError("the server does not read what is sent to it");
    taken(explained([&] { return socket_.receive(in_.space()); }));
    if (socket_.is_secure()) drain();
  }
}

bool Connection::Impl::receive(Deadline deadline) {
  if (!out_.empty()) flush();
  const bool any = taken(explained([&] { return socket_.receive(in_.space(), deadline); }));
  if (any && socket_.is_secure()) drain();
  return any;
}

// A caller that polls the socket cannot see bytes that TLS holds back, so all of them are read at once. If
// the stream ends here, the next receive() meets that end again, after the frames that came before it.
void Connection::Impl::drain() try {
  while (taken(socket_.receive(in_.space()))) {
  }
} catch (const std::runtime_error&) {
  // The next receive() reports it.
}

bool Connection::Impl::taken(std::size_t received) {
  in_.commit(received);
  read_frames();
  return received > 0;
}

// Runs `call`. If the connection is lost, first reads what the server sent before, and adds its last error to
// the exception: that may say why.
template <typename Call>
std::size_t Connection::Impl::explained(Call call) {
  try {
    return call();
  } catch (const ConnectionError& error) {
    try {
      while (taken(socket_.receive(in_.space()))) {
      }
    } catch (const ConnectionError&) {
      // All is read.
    }
    if (inbox_.last_error().empty()) throw;
    throw ConnectionError(std::string(error.what()) + ": " + inbox_.last_error());
  }
}

void Connection::Impl::read_frames() {
  for (;;) {
    const FrameBuffer::Next next = in_.next(Limits{}.max_frame_to_client);
    if (next.state == FrameBuffer::State::kTooLarge)
      throw ConnectionError("the server sent a frame of " + std::to_string(next.length) +
                            " bytes: is this Visum?");
    if (next.state != FrameBuffer::State::kFrame) return;
    std::string why;
    auto frame = decode_reply(next.payload, why);
    if (!frame) throw ConnectionError("the server sent something that is not a reply: " + why);
    inbox_.put(std::move(*frame));
  }
}

// ---------------------------------------- requests

Deadline Connection::Impl::deadline_of(std::uint64_t id) {
  return inbox_.unbounded(id) ? kNever : steady_clock::now() + timeout_;
}

std::optional<Reply> Connection::Impl::wait_for(std::uint64_t id, Deadline deadline) {
  for (;;) {
    if (auto reply = inbox_.take_reply(id)) {
      if (const auto* error = std::get_if<Error>(&*reply))
        throw RequestError(error->code, error->text, error->owner);
      return reply;
    }
    if (!receive(deadline)) return std::nullopt;
  }
}

Reply Connection::Impl::wait(std::uint64_t id, Deadline deadline) {
  if (auto reply = wait_for(id, deadline)) return std::move(*reply);
  inbox_.forget(id);
  throw RequestError(ErrorCode::kTimeout, "no answer within " + std::to_string(timeout_.count()) + " ms");
}

// The server may refuse (busy, ...) before it looks at the hello. Such an Error answers no request, but it
// counts as the answer here.
void Connection::Impl::say_hello(const Hello& hello, Deadline deadline) {
  const std::uint64_t id = encode(hello);
  try {
    flush();
    Reply reply = wait(id, deadline);
    if (!std::holds_alternative<Welcome>(reply))
      throw ConnectionError("the server did not answer Hello with Welcome");
    welcome_ = std::get<Welcome>(std::move(reply));
  } catch (const ConnectionError&) {
    while (auto reply = inbox_.take_next())
      if (const auto* error = std::get_if<Error>(&*reply))
        throw RequestError(error->code, error->text, error->owner);
    throw;
  }
}

Connection::Connection(const std::string& host, std::uint16_t port, const Hello& hello, milliseconds timeout,
                       const TlsFiles& tls) {
  const Deadline deadline = steady_clock::now() + timeout;
  impl_ = std::make_unique<Impl>(host, port, timeout, tls);
  impl_->say_hello(hello, deadline);
}

Connection::~Connection() = default;
Connection::Connection(Connection&&) noexcept = default;
Connection& Connection::operator=(Connection&&) noexcept = default;

const Welcome& Connection::welcome() const {
  return impl_->welcome_;
}

Reply Connection::request(const Request& request) {
  return wait(send(request));
}

void Connection::post(const Request& request) {
  encode_request(0, request, impl_->out_);
  impl_->flush();
}

std::uint64_t Connection::send(const Request& request) {
  const std::uint64_t id = impl_->encode(request);
  impl_->flush();
  return id;
}

std::uint64_t Connection::send_along(const Request& request) {
  return impl_->encode(request);
}

std::vector<std::uint64_t> Connection::send_together(const std::vector<Request>& requests) {
  std::vector<std::uint64_t> ids;
  for (const Request& request : requests) ids.push_back(impl_->encode(request));
  impl_->flush();
  return ids;
}

Reply Connection::wait(std::uint64_t id) {
  return impl_->wait(id, impl_->deadline_of(id));
}

std::optional<Reply> Connection::wait_for(std::uint64_t id, milliseconds timeout) {
  return impl_->wait_for(id, steady_clock::now() + timeout);
}

std::optional<Reply> Connection::next(milliseconds timeout) {
  const Deadline deadline = steady_clock::now() + timeout;
  for (;;) {
    if (auto reply = impl_->inbox_.take_next()) return reply;
    if (!impl_->receive(deadline)) return std::nullopt;
  }
}

std::optional<Reply> Connection::next_kept() {
  return impl_->inbox_.take_next();
}

int Connection::native_handle() const {
  return impl_->socket_.fd();
}

std::pair<std::string, std::uint16_t> parse_address(const std::string& text) {
  const auto fail = [&](const char* why) {
    throw std::invalid_argument("'" + text + "' is not HOST:PORT, [IPV6]:PORT or PORT: " + why);
  };
  const std::size_t colon = text.rfind(':');
  std::string host = colon == std::string::npos ? "127.0.0.1" : text.substr(0, colon);
  const std::string digits = colon == std::string::npos ? text : text.substr(colon + 1);
  if (host.size() > 2 && host.front() == '[' && host.back() == ']')
    host = host.substr(1, host.size() - 2);
  else if (host.find_first_of(":[]") != std::string::npos)
    fail("an IPv6 address stands in brackets");
  if (host.empty()) fail("the host is missing");
  unsigned port = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (error != std::errc{} || end != digits.data() + digits.size() || port < 1 || port > 65535)
    fail("the port is a number from 1 to 65535");
  return {host, static_cast<std::uint16_t>(port)};
}

}  // namespace visum::protocol

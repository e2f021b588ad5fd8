// Any bytes that a browser might send to the HTTP port: as requests, and after a handshake as the stream of a
// WebSocket and as its messages. The server's own connection and session are at the other end of a socket
// pair, so no network is needed. The result must be answers and an end.
#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/io_context.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "protocol/codec.h"
#include "protocol/http_connection.h"
#include "protocol/limits.h"
#include "protocol/web_session.h"
#include "protocol/web_upgrade.h"
#include "tests/fuzz/answering.h"

namespace {

using namespace visum::protocol;
using boost::asio::ip::tcp;
using visum::testing::Answering;
using visum::testing::fail;
using Bytes = std::span<const std::byte>;

constexpr std::uint16_t kPort = 8080;
const std::set<std::string> kHosts = {"localhost:8080", "127.0.0.1:8080", "[::1]:8080", "visum.lab:8080"};
const std::string kHandshake =
    "GET /session HTTP/1.1\r\nHost: localhost:8080\r\nOrigin: http://localhost:8080\r\nConnection: "
    "Upgrade\r\n"
    "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
    "Sec-WebSocket-Protocol: visum.v1\r\n\r\n";

struct Pages final : WebPages {
  WebReply get(const WebRequest& request) override {
    if (path_of(request.path) != request.path) fail("a page was asked for by what is no path");
    WebReply reply;
    reply.text = request.path;
    return reply;
  }
};

std::string in_small_letters(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c | 0x20);
  return text;
}

// One connection: the server's end, as protocol/server.cc keeps it, and the browser's end.
class Line final : HttpOwner, SessionOwner {
 public:
  Line() {
    std::array<int, 2> ends{};
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) != 0)
      fail("there is no socket pair");
    tcp::socket socket(io_);
    socket.assign(tcp::v4(), ends[0]);
    browser_ = ends[1];
    connection_.emplace(std::move(socket), tcp::endpoint(), nullptr, rules_, pages_, context_,
                        static_cast<HttpOwner&>(*this));
    connection_->start();
    turn();
  }
  ~Line() { leave(); }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  void send(Bytes bytes) {
    while (!bytes.empty() && !over()) {
      const auto sent = ::send(browser_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent > 0) bytes = bytes.subspan(static_cast<std::size_t>(sent));
      turn();
      if (sent <= 0) return;  // the server reads no more
    }
  }
  void send_in_pieces(Bytes bytes) {
    const std::size_t piece = bytes.empty() ? 1 : 1 + static_cast<std::size_t>(bytes.back());
    for (std::size_t at = 0; at < bytes.size(); at += piece)
      send(bytes.subspan(at, std::min(piece, bytes.size() - at)));
  }
  bool upgraded() const { return was_upgraded_; }

  // Sends nothing for longer than any deadline, then closes the browser's end.
  void end() {
    for (int i = 0; i < 4; ++i) {
      context_.now += std::chrono::hours(1);
      connection_->sweep();
      if (session_) session_->sweep();
      turn();
    }
    const bool silent_before_hello = session_ && session_->awaits_hello();
    if (!connection_->finished() || silent_before_hello) fail("who says nothing is kept for ever");
    leave();
    turn();
    if (!over()) fail("a connection did not end");
    if (handler_.open != 0) fail("a close was told twice or never");
    if (!answers_.empty() && !answers_.starts_with("HTTP/1.1 ")) fail("an answer that is none");
  }

 private:
  void http_connected() override {}
  void woken(WireSession& session) override { woken_.push_back(&session); }
  std::string refuse_place(const WireSession&, Role) const override { return {}; }
  bool looks_after(WireSession&) override { return false; }
  void upgraded(UpgradePointer upgrade) override {
    const auto text = [&](auto field) { return std::string(upgrade->request[field]); };
    const auto host = in_small_letters(text(boost::beast::http::field::host));
    if (was_upgraded_) fail("one connection became two sessions");
    if (!kHosts.contains(host) && host != "[::]:8080") fail("a session for a strange host");
    const auto origin = text(boost::beast::http::field::origin);
    if (!origin.starts_with("http://") || in_small_letters(origin) != "http://" + host)
      fail("a session for a strange page");
    was_upgraded_ = true;
    session_ = make_web_session(context_, *this, 1, tcp::endpoint(), std::move(upgrade));
    session_->start();
  }

  bool over() const { return connection_->finished() && !session_; }
  void leave() {
    if (browser_ >= 0) ::close(browser_);
    browser_ = -1;
  }
  void turn() {
    do {
      settle();
      read();
      io_.restart();
    } while (io_.poll() > 0 || !woken_.empty());
  }
  void settle() {
    for (std::size_t i = 0; i < woken_.size(); ++i) woken_[i]->work();
    woken_.clear();
    if (session_ && session_->finished() && !session_->is_woken()) session_.reset();
  }
  void read() {
    std::array<char, 4096> space{};
    for (ssize_t bytes = 1; browser_ >= 0 && bytes > 0;) {
      bytes = ::recv(browser_, space.data(), space.size(), 0);
      if (bytes > 0 && answers_.size() < 16) answers_.append(space.data(), static_cast<std::size_t>(bytes));
    }
  }

  boost::asio::io_context io_{1};
  const Limits limits_;
  Answering handler_;
  SessionContext context_{limits_, handler_};
  const HttpRules rules_{kPort, {"visum.lab"}};
  Pages pages_;
  std::optional<HttpConnection> connection_;
  std::unique_ptr<WireSession> session_;
  std::vector<WireSession*> woken_;
  std::string answers_;  // the first bytes of the answers
  bool was_upgraded_ = false;
  int browser_ = -1;
};

// A masked frame with a correct length.
void put_frame(std::vector<std::byte>& to, std::uint8_t kind, Bytes payload) {
  constexpr std::array<std::uint8_t, 4> kMask = {0x12, 0x34, 0x56, 0x78};
  const auto put = [&](std::size_t value) { to.push_back(static_cast<std::byte>(value & 0xff)); };
  put(kind);
  put(0x80 | (payload.size() < 126 ? payload.size() : 126));
  if (payload.size() >= 126) put(payload.size() >> 8), put(payload.size());
  for (const auto byte : kMask) put(byte);
  for (std::size_t i = 0; i < payload.size(); ++i)
    put(std::to_integer<std::uint8_t>(payload[i]) ^ kMask[i % 4]);
}

// Frames [kind, size, bytes...], repeated, after a hello.
std::vector<std::byte> as_frames(Bytes bytes) {
  std::vector<std::byte> hello, frames;
  encode_request(1, Hello{1, kProtocolVersion, "fuzz", Role::kAdmin, ""}, hello);
  put_frame(frames, 0x82, hello);
  while (bytes.size() >= 2) {
    const auto size = std::min(std::to_integer<std::size_t>(bytes[1]), bytes.size() - 2);
    put_frame(frames, std::to_integer<std::uint8_t>(bytes[0]), bytes.subspan(2, size));
    bytes = bytes.subspan(2 + size);
  }
  return frames;
}

void after_a_handshake(Bytes bytes) {
  Line line;
  line.send(std::as_bytes(std::span(kHandshake)));
  if (!line.upgraded()) fail("a browser was turned away");
  line.send_in_pieces(bytes);
  line.end();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool quiet = (spdlog::set_level(spdlog::level::off), true);
  static_cast<void>(quiet);
  const Bytes bytes = std::as_bytes(std::span(data, size));
  Line line;
  line.send_in_pieces(bytes);
  line.end();
  after_a_handshake(bytes);
  after_a_handshake(as_frames(bytes));
  return 0;
}

#include "protocol/stop_call.h"

#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <memory>
#include <vector>

#include "protocol/client.h"

namespace visum::protocol {
namespace {

using std::chrono::milliseconds;
using std::chrono::steady_clock;
using State = StopNews::State;

constexpr milliseconds kAgain{10};  // how soon a datagram that was not answered is sent again

// One of the addresses of the host, with a socket of its own.
class Way {
 public:
  explicit Way(const addrinfo& to)
      : fd_(::socket(to.ai_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)), length_(to.ai_addrlen) {
    std::copy_n(reinterpret_cast<const std::byte*>(to.ai_addr), length_, reinterpret_cast<std::byte*>(&to_));
  }
  Way(Way&& other) noexcept : fd_(std::exchange(other.fd_, -1)), to_(other.to_), length_(other.length_) {}
  Way& operator=(Way&&) = delete;
  ~Way() {
    if (fd_ >= 0) ::close(fd_);
  }
  int fd() const { return fd_; }
  // A datagram that does not leave is like one that is lost: it is sent again.
  void send(const std::vector<std::byte>& bytes) const {
    ::sendto(fd_, bytes.data(), bytes.size(), MSG_NOSIGNAL, reinterpret_cast<const sockaddr*>(&to_), length_);
  }
  std::optional<StopDatagram> receive() const {
    std::array<std::byte, kStopOrderBytes + 1> buffer;
    const auto got = ::recv(fd_, buffer.data(), buffer.size(), 0);
    if (got < 0) return std::nullopt;
    return decode_stop(std::span(buffer).first(static_cast<std::size_t>(got)));
  }

 private:
  int fd_;
  sockaddr_storage to_{};
  socklen_t length_;
};

std::vector<Way> ways_to(const std::string& host, std::uint16_t port) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* list = nullptr;
  const int failure = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &list);
  if (failure != 0) throw ConnectionError("cannot find the host '" + host + "': " + ::gai_strerror(failure));
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owned(list, &::freeaddrinfo);
  std::vector<Way> ways;
  for (const auto* entry = list; entry; entry = entry->ai_next) ways.emplace_back(*entry);
  return ways;
}

class Call {
 public:
  Call(const std::string& part, const std::string& token, const std::function<void(const StopNews&)>& on_news)
      : part_(part), token_(token), on_news_(on_news) {
    fill_with_random(nonce_);
  }

  StopNews run(const std::vector<Way>& ways, steady_clock::time_point deadline, const std::stop_token& end) {
    std::vector<pollfd> polled;
    for (const auto& way : ways) polled.push_back({way.fd(), POLLIN, 0});
    for (auto now = steady_clock::now(); now < deadline && !end.stop_requested(); now = steady_clock::now()) {
      const auto bytes = encode(next());
      for (const auto& way : ways) way.send(bytes);
      const auto again = std::min(deadline, now + kAgain);
      for (bool moved = false; !moved && (now = steady_clock::now()) < again;) {
        ::poll(polled.data(), polled.size(),
               static_cast<int>(std::chrono::ceil<milliseconds>(again - now).count()));
        for (const auto& way : ways)
          if (const auto answer = way.receive()) moved = take(*answer) || moved;
        if (news_.state == State::kActed || news_.state == State::kRefused) return news_;
      }
    }
    return news_;
  }

 private:
  StopDatagram next() const {
    if (!challenge_) return StopAsk{nonce_};
    const bool proves = challenge_->proof == StopProof::kToken;
    return StopOrder{nonce_, challenge_->cookie,
                     proves ? stop_proof(token_, challenge_->cookie, part_) : KeyedHash{}, part_};
  }

  // True if there is something new to send.
  bool take(const StopDatagram& answer) {
    if (const auto* challenge = std::get_if<StopChallenge>(&answer)) {
      if (challenge->nonce != nonce_ || challenge_) return false;
      challenge_ = *challenge;
      if (challenge->proof == StopProof::kSession)
        tell({State::kRefused, 0, StopRefusal::kSession});
      else
        tell({State::kAnswered});
      return true;
    }
    if (const auto* latched = std::get_if<StopLatched>(&answer); latched && latched->nonce == nonce_)
      tell({State::kLatched});
    if (const auto* acted = std::get_if<StopActed>(&answer); acted && acted->nonce == nonce_)
      tell({State::kActed, acted->tick});
    if (const auto* refused = std::get_if<StopRefused>(&answer); refused && refused->nonce == nonce_) {
      if (refused->why == StopRefusal::kCookie) {
        challenge_.reset();
        return true;
      }
      tell({State::kRefused, 0, refused->why});
    }
    return false;
  }

  void tell(const StopNews& news) {
    if (news.state <= news_.state) return;
    news_ = news;
    on_news_(news_);
  }

  const std::string& part_;
  const std::string& token_;
  const std::function<void(const StopNews&)>& on_news_;
  StopNonce nonce_{};
  std::optional<StopChallenge> challenge_;
  StopNews news_;
};

}  // namespace

StopNews call_stop(const std::string& host, std::uint16_t port, const std::string& part,
                   const std::string& token, milliseconds at_most,
                   const std::function<void(const StopNews&)>& on_news, const std::stop_token& end) {
  const auto deadline = steady_clock::now() + at_most;
  const auto ways = ways_to(host, port);
  return Call(part, token, on_news).run(ways, deadline, end);
}

}  // namespace visum::protocol

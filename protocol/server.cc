#include "protocol/server.h"

#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/address.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cerrno>
#include <cstring>
#include <map>
#include <stdexcept>
#include <utility>

#include "protocol/codec.h"
#include "protocol/tcp_session.h"
#include "protocol/token_bucket.h"

namespace visum::protocol {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kAcceptBackoff{100};
constexpr std::size_t kMaxLeaving = 64;   // refused sessions that linger; above it they are cut off
constexpr std::size_t kSpareEvents = 16;  // per poll(), beyond one for each session
constexpr int kBacklog = 512;

asio::ip::address address_of(const std::string& text) {
  if (text == "localhost") return asio::ip::address_v4::loopback();
  error_code error;
  const auto address = asio::ip::make_address(text, error);
  if (error) throw std::runtime_error("cannot listen on '" + text + "': not an IP address");
  return address;
}

bool is_loopback(const asio::ip::address& address) {
  if (address.is_v6() && address.to_v6().is_v4_mapped())
    return asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6()).is_loopback();
  return address.is_loopback();
}

// The sweep is fine enough for the shortest deadline, and rare enough to cost nothing.
milliseconds sweep_period(const Limits& limits) {
  const milliseconds shortest =
      std::min({limits.hello_deadline, limits.frame_deadline, limits.stall_deadline});
  return std::clamp(shortest / 10, milliseconds(5), milliseconds(50));
}

int make_eventfd() {
  const int fd = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (fd < 0) throw std::runtime_error(std::string("eventfd: ") + std::strerror(errno));
  return fd;
}

}  // namespace

struct Server::Impl final : SessionOwner {
  Impl(const ListenOptions& options, SessionHandler& handler);
  ~Impl() override;

  void woken(TcpSession& session) override { woken_.push_back(&session); }

  void listen();
  void accept_when_allowed();
  void accept_after(std::chrono::nanoseconds pause);
  void accept();
  void on_accept(const error_code& error, tcp::socket socket);
  void accept_failed(const error_code& error);
  void admit(tcp::socket socket);
  std::string refusal(const asio::ip::address& peer) const;
  void turn_away(tcp::socket& socket, const std::string& why);
  std::size_t count(bool (*of)(const TcpSession&)) const;

  void await_signal();
  void on_signal();
  void signal();
  void begin_shutdown();

  void arm_sweep();
  void sweep();

  void settle();
  void count_open();
  bool over() const { return stopping_ && sessions_.empty(); }

  // Destroyed last, so that sockets and timers go before it; it then drops pending handlers without calling
  // them.
  asio::io_context io_{1};
  asio::executor_work_guard<asio::io_context::executor_type> stay_{io_.get_executor()};
  const ListenOptions options_;
  SessionHandler& handler_;
  SessionContext context_{options_.limits, handler_};
  tcp::acceptor acceptor_{io_};
  std::uint16_t port_ = 0;
  asio::steady_timer accept_timer_{io_};
  TokenBucket accepts_;
  bool accept_failing_ = false;
  const milliseconds sweep_period_;
  asio::steady_timer sweep_timer_{io_};
  bool sweeping_ = false;
  steady_clock::time_point last_sweep_;
  asio::posix::stream_descriptor signal_fd_;
  std::uint64_t signal_value_ = 0;
  std::atomic<bool> signalled_{false};
  std::atomic<bool> stop_asked_{false};
  std::atomic<bool> notified_{false};
  bool stopping_ = false;
  std::map<std::uint64_t, std::unique_ptr<TcpSession>> sessions_;
  std::uint64_t next_id_ = 1;
  std::vector<TcpSession*> woken_;
  std::atomic<std::size_t> open_sessions_{0};
};

Server::Impl::Impl(const ListenOptions& options, SessionHandler& handler)
    : options_(options),
      handler_(handler),
      accepts_(options.limits.accepts_per_second, steady_clock::now()),
      sweep_period_(sweep_period(options.limits)),
      signal_fd_(io_, make_eventfd()) {
  context_.step = sweep_period_;
  listen();
  await_signal();
}

Server::Impl::~Impl() {
  for (auto& [id, session] : sessions_) session->let_go();
}

// ----------------------------------------------------------------------------------------------------
// accepting

void Server::Impl::listen() {
  const tcp::endpoint endpoint(address_of(options_.address), options_.port);
  try {
    acceptor_.open(endpoint.protocol());
    acceptor_.set_option(tcp::acceptor::reuse_address(true));
    acceptor_.bind(endpoint);
    acceptor_.listen(kBacklog);
    port_ = acceptor_.local_endpoint().port();
  } catch (const boost::system::system_error& error) {
    throw std::runtime_error("cannot listen on " + to_text(endpoint) + ": " + error.code().message());
  }
}

void Server::Impl::accept_when_allowed() {
  if (!acceptor_.is_open()) return;
  if (accepts_.take(steady_clock::now())) return accept();
  accept_after(accepts_.wait());
}

void Server::Impl::accept_after(std::chrono::nanoseconds pause) {
  accept_timer_.expires_after(pause);
  accept_timer_.async_wait([this](const error_code& error) {
    if (!error) accept_when_allowed();
  });
}

void Server::Impl::accept() {
  acceptor_.async_accept(
      [this](const error_code& error, tcp::socket socket) { on_accept(error, std::move(socket)); });
}

void Server::Impl::on_accept(const error_code& error, tcp::socket socket) {
  if (!acceptor_.is_open()) return;
  if (error && error != asio::error::connection_aborted) return accept_failed(error);
  accept_failing_ = false;
  if (!error) admit(std::move(socket));
  accept_when_allowed();
}

// Mostly no descriptors left: they come back when sessions end, so try again, but not in a loop.
void Server::Impl::accept_failed(const error_code& error) {
  if (!std::exchange(accept_failing_, true))
    spdlog::warn("cannot accept connections on port {}: {}; trying again", port_, error.message());
  accept_after(kAcceptBackoff);
}

void Server::Impl::admit(tcp::socket socket) {
  error_code error;
  const tcp::endpoint peer = socket.remote_endpoint(error);
  if (error) return;  // gone already
  const std::string why = refusal(peer.address());
  if (!why.empty() && count([](const TcpSession& s) { return s.closing(); }) >= kMaxLeaving)
    return turn_away(socket, why);
  const std::uint64_t id = next_id_++;
  auto& session = sessions_[id] = std::make_unique<TcpSession>(context_, *this, std::move(socket), id, peer);
  if (why.empty())
    session->start();
  else
    session->refuse(0, {ErrorCode::kBusy, why, {}});
  count_open();
  arm_sweep();
}

std::string Server::Impl::refusal(const asio::ip::address& peer) const {
  const Limits& limits = options_.limits;
  std::size_t open = 0, before_hello = 0, of_peer = 0;
  for (const auto& [id, session] : sessions_) {
    if (session->closing()) continue;
    ++open;
    before_hello += session->awaits_hello();
    of_peer += session->address() == peer;
  }
  if (open >= limits.max_sessions)
    return "the limit of " + std::to_string(limits.max_sessions) + " sessions is reached";
  if (before_hello >= limits.max_unauthenticated) return "too many clients that have not said Hello yet";
  if (of_peer >= limits.max_sessions_per_peer && !is_loopback(peer))
    return "the limit of " + std::to_string(limits.max_sessions_per_peer) +
           " sessions from one address is reached";
  return {};
}

// Without a session: as much of the reason as goes at once.
void Server::Impl::turn_away(tcp::socket& socket, const std::string& why) {
  context_.refused.fetch_add(1, std::memory_order_relaxed);
  std::vector<std::byte> frame;
  encode_reply(0, Error{ErrorCode::kBusy, why, {}}, frame);
  error_code ignored;
  socket.non_blocking(true, ignored);
  socket.write_some(asio::buffer(frame.data(), frame.size()), ignored);
}

std::size_t Server::Impl::count(bool (*of)(const TcpSession&)) const {
  return static_cast<std::size_t>(std::count_if(sessions_.begin(), sessions_.end(),
                                                [of](const auto& entry) { return of(*entry.second); }));
}

void Server::Impl::count_open() {
  open_sessions_.store(count([](const TcpSession& s) { return !s.closing(); }), std::memory_order_relaxed);
}

// ---------------------------------------------------------------------------------------------------- other
// threads

// One write wakes the server, however often it is asked until it looks.
void Server::Impl::signal() {
  if (signalled_.exchange(true)) return;
  const std::uint64_t one = 1;
  // Can fail only if the counter is full, and then the server is awake.
  [[maybe_unused]] const auto written = ::write(signal_fd_.native_handle(), &one, sizeof one);
}

void Server::Impl::await_signal() {
  signal_fd_.async_read_some(asio::buffer(&signal_value_, sizeof signal_value_),
                             [this](const error_code& error, std::size_t) {
                               if (error) return;
                               on_signal();
                               await_signal();
                             });
}

void Server::Impl::on_signal() {
  signalled_.store(false);
  if (stop_asked_.load()) begin_shutdown();
  if (!notified_.exchange(false)) return;
  try {
    handler_.on_notify();
  } catch (const std::exception& error) {
    spdlog::error("internal error in a notification: {}", error.what());
  } catch (...) {
    spdlog::error("internal error in a notification");
  }
}

void Server::Impl::begin_shutdown() {
  if (std::exchange(stopping_, true)) return;
  error_code ignored;
  acceptor_.close(ignored);
  accept_timer_.cancel(ignored);
  for (auto& [id, session] : sessions_) session->close(CloseReason::kShutdown);
}

// ----------------------------------------------------------------------------------------------------
// deadlines

void Server::Impl::arm_sweep() {
  if (sweeping_ || sessions_.empty()) return;
  sweeping_ = true;
  last_sweep_ = steady_clock::now();
  sweep_timer_.expires_after(sweep_period_);
  sweep_timer_.async_wait([this](const error_code& error) {
    sweeping_ = false;
    if (!error) sweep();
  });
}

void Server::Impl::sweep() {
  // What is more than two periods was not spent serving: nobody's deadline runs while the server looks
  // elsewhere.
  context_.now += std::min<ServedTime>(steady_clock::now() - last_sweep_, 2 * sweep_period_);
  for (auto& [id, session] : sessions_) session->sweep();
  arm_sweep();
}

// ---------------------------------------------------------------------------------------------------- the
// loop

// The end of an event: closes are told, batches written, the finished freed. Whatever this wakes is settled
// as well.
void Server::Impl::settle() {
  if (woken_.empty()) return;
  bool any_closed = false;
  for (std::size_t i = 0; i < woken_.size(); ++i) {
    TcpSession& session = *woken_[i];
    session.work();
    any_closed |= session.closing();
    if (session.finished() && !session.is_woken()) sessions_.erase(session.id());
  }
  woken_.clear();
  if (any_closed) count_open();
}

Server::Server(const ListenOptions& options, SessionHandler& handler)
    : impl_(std::make_unique<Impl>(options, handler)) {}

Server::~Server() = default;

std::uint16_t Server::port() const {
  return impl_->port_;
}

void Server::start() {
  impl_->accept_when_allowed();
}

void Server::run() {
  for (impl_->settle(); !impl_->over(); impl_->settle()) impl_->io_.run_one();
}

bool Server::poll() {
  impl_->settle();
  bool any = false;
  // Bounded, so that no client can hold the caller here.
  for (std::size_t left = impl_->sessions_.size() + kSpareEvents; left > 0 && impl_->io_.poll_one() > 0;
       --left) {
    any = true;
    impl_->settle();
  }
  return any;
}

void Server::poll_for(std::chrono::nanoseconds at_most) {
  impl_->settle();
  if (at_most.count() > 0 && impl_->io_.run_one_for(at_most) == 0) return;
  poll();
}

void Server::stop() {
  impl_->stop_asked_.store(true);
  impl_->signal();
}

void Server::notify() {
  impl_->notified_.store(true);
  impl_->signal();
}

std::size_t Server::session_count() const {
  return impl_->open_sessions_.load(std::memory_order_relaxed);
}

std::uint64_t Server::refused() const {
  return impl_->context_.refused.load(std::memory_order_relaxed);
}

}  // namespace visum::protocol

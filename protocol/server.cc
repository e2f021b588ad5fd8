#include "protocol/server.h"

#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cerrno>
#include <cstring>
#include <limits>
#include <map>
#include <new>
#include <stdexcept>
#include <utility>

#include "protocol/busy_wait.h"
#include "protocol/codec.h"
#include "protocol/http_door.h"
#include "protocol/listener.h"
#include "protocol/local_door.h"
#include "protocol/local_socket.h"
#include "protocol/stream_session.h"
#include "protocol/talker.h"
#include "protocol/web_session.h"

namespace visum::protocol {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr std::size_t kMaxLeaving = 64;   // refused sessions that linger; further ones are cut off
constexpr milliseconds kNothingToDo{1};   // a wait after which sessions get what they hold back
constexpr std::size_t kSpareEvents = 16;  // handled per poll(), beyond one for each session

// Fine enough for the shortest deadline, and rare enough to cost nothing.
milliseconds sweep_period(const Limits& limits) {
  const milliseconds shortest =
      std::min({limits.hello_deadline, limits.frame_deadline, limits.stall_deadline});
  return std::clamp(shortest / 10, milliseconds(5), milliseconds(50));
}

std::string kept_for_admins(const Limits& limits, Role role) {
  if (role == Role::kAdmin || limits.places_for_admins == 0) return {};
  return ", but for " + std::to_string(limits.places_for_admins) + " that are kept for admins";
}

int make_eventfd() {
  const int fd = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  if (fd < 0) throw std::runtime_error(std::string("eventfd: ") + std::strerror(errno));
  return fd;
}

}  // namespace

struct Server::Impl final : SessionOwner, HttpOwner {
  Impl(const ListenOptions& options, SessionHandler& handler);
  ~Impl() override;

  void woken(WireSession& session) override { woken_.push_back(&session); }
  std::string refuse_place(const WireSession& session, Role role) const override;
  bool looks_after(WireSession& session) override { return talker_.takes(session); }
  void http_connected() override { arm_sweep(); }
  void upgraded(UpgradePointer upgrade) override;

  // Makes a session of a new connection.
  void admit(tcp::socket socket, const tcp::endpoint& peer);
  void admit_local(LocalDoor::Socket socket);
  void open_local_door();
  // Owns and starts a session.
  void keep(std::unique_ptr<WireSession> session);
  // If too many sessions have not said Hello, ends the oldest one of the address with the most of them. So a
  // client that says Hello at once is never kept out by silent ones.
  void make_room_for(const asio::ip::address& newcomer);
  // So many refused sessions linger that the next one is cut off.
  bool crowded() const {
    return count([](const WireSession& s) { return s.closing(); }) >= kMaxLeaving;
  }
  std::size_t count(bool (*of)(const WireSession&)) const;

  // Other threads wake the server by an eventfd: signal() writes it, on_signal() runs on the server's thread.
  void await_signal();
  void on_signal();
  void notify_handler();
  void signal();
  void begin_shutdown();

  // The sweep checks all deadlines. Its timer runs only while there are sessions or connections.
  void arm_sweep();
  void sweep();

  enum class Held { kStay, kLeave };  // sessions that hold back: leave them alone, or write
  void settle(Held held = Held::kLeave);
  bool serve_ready();
  bool look_at_talker() {
    return run_handlers([this](auto&) { return std::size_t{talker_.look()}; }) > 0;
  }
  bool wait(std::chrono::nanoseconds at_most);  // false: nothing came
  // Runs handlers. Where memory runs out within Asio or Beast, that costs the connection at hand.
  template <typename Run>
  std::size_t run_handlers(Run run);
  void count_open();  // publishes the number of open sessions for other threads
  bool over() const { return stopping_ && sessions_.empty(); }

  // Members are destroyed from the last to the first. So sockets and timers go before the io_context, which
  // then drops pending handlers without calling them. Only tls_, which its handlers use, outlives it.
  std::unique_ptr<TlsContext> tls_;  // null: plain text
  asio::io_context io_{1};
  asio::executor_work_guard<asio::io_context::executor_type> stay_{io_.get_executor()};
  const ListenOptions options_;
  SessionHandler& handler_;
  SessionContext context_{options_.limits, handler_};
  Listener listener_{
      io_,
      options_.address,
      options_.port,
      options_.limits.accepts_per_second,
      [this](tcp::socket socket, const tcp::endpoint& peer) { admit(std::move(socket), peer); },
      [this] { context_.refused.fetch_add(1, std::memory_order_relaxed); }};
  std::unique_ptr<HttpDoor> http_;    // null: no HTTP
  std::unique_ptr<LocalDoor> local_;  // null: TCP only
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
  std::map<std::uint64_t, std::unique_ptr<WireSession>> sessions_;
  std::uint64_t next_id_ = 1;
  std::vector<WireSession*> woken_;
  BusyWait busy_wait_;
  Talker talker_;
  bool more_came_ = false;  // when all were looked at last
  std::atomic<std::size_t> open_sessions_{0};
};

Server::Impl::Impl(const ListenOptions& options, SessionHandler& handler)
    : tls_(options.tls.given() ? std::make_unique<TlsContext>(options.tls, TlsContext::Side::kServer)
                               : nullptr),
      options_(options),
      handler_(handler),
      sweep_period_(sweep_period(options.limits)),
      signal_fd_(io_, make_eventfd()) {
  context_.step = sweep_period_;
  if (options_.web.pages)
    http_ = std::make_unique<HttpDoor>(io_, options_.address, options_.web, tls_.get(), context_, *this);
  open_local_door();
  await_signal();
}

Server::Impl::~Impl() {
  for (auto& [id, session] : sessions_) session->let_go();
}

// ---------------------------------------- accepting

void Server::Impl::admit(tcp::socket socket, const tcp::endpoint& peer) {
  make_room_for(peer.address());
  keep(std::make_unique<StreamSession>(context_, *this, std::move(socket), next_id_++, peer, tls_.get()));
}

void Server::Impl::open_local_door() {
  const std::string name = local_socket_name(listener_.port());
  const bool is_reached = options_.address == "127.0.0.1" || options_.address == "0.0.0.0";
  if (name.empty() || tls_ || !is_reached) return;
  try {
    local_ = std::make_unique<LocalDoor>(
        io_, name, [this](LocalDoor::Socket socket) { admit_local(std::move(socket)); });
  } catch (const std::runtime_error& error) {
    spdlog::warn("{}: all clients use TCP", error.what());
  }
}

void Server::Impl::admit_local(LocalDoor::Socket socket) {
  make_room_for(asio::ip::address_v4::loopback());
  keep(std::make_unique<StreamSession>(context_, *this, std::move(socket), next_id_++));
}

// From here on it is a session like any other, with the same limits and the same refusals.
void Server::Impl::upgraded(UpgradePointer upgrade) {
  tcp::endpoint peer;
  if (stopping_ || !peer_of(*upgrade, peer)) return;
  make_room_for(peer.address());
  keep(make_web_session(context_, *this, next_id_++, peer, std::move(upgrade)));
}

void Server::Impl::keep(std::unique_ptr<WireSession> session) {
  WireSession& kept = *(sessions_[session->id()] = std::move(session));
  kept.start();
  count_open();
  arm_sweep();
}

void Server::Impl::make_room_for(const asio::ip::address& newcomer) {
  std::map<asio::ip::address, std::vector<WireSession*>> silent;  // by address, the oldest first
  std::size_t count = 0;
  for (auto& [id, session] : sessions_) {
    if (!session->awaits_hello()) continue;
    silent[share_of(session->address())].push_back(session.get());
    ++count;
  }
  if (count < options_.limits.max_unauthenticated) return;
  const auto weight = [own = share_of(newcomer)](const auto& entry) {
    const auto age = std::numeric_limits<std::uint64_t>::max() - entry.second.front()->id();
    return std::pair(entry.second.size() + (entry.first == own), age);
  };
  const auto busiest = std::ranges::max_element(silent, {}, weight);
  if (busiest == silent.end()) return;
  WireSession& oldest = *busiest->second.front();
  const bool crowd = crowded();
  oldest.refuse(0,
                {ErrorCode::kBusy, "its place was given to a newer connection, because it was silent", {}});
  if (crowd) oldest.let_go();
}

// Called when a session says Hello, which is the moment from which it counts.
std::string Server::Impl::refuse_place(const WireSession& session, Role role) const {
  const Limits& limits = options_.limits;
  const auto share = share_of(session.address());
  std::size_t open = 0, of_peer = 0;
  for (const auto& [id, other] : sessions_) {
    if (other->closing() || other->awaits_hello()) continue;
    ++open;
    of_peer += share_of(other->address()) == share;
  }
  const std::size_t more = role == Role::kAdmin ? limits.places_for_admins : 0;
  if (open + limits.places_for_admins >= limits.max_sessions + more)
    return "the limit of " + std::to_string(limits.max_sessions) + " sessions is reached" +
           kept_for_admins(limits, role);
  const bool local = unmapped(session.address()).is_loopback();
  const std::size_t most = local ? limits.max_sessions_per_local_peer : limits.max_sessions_per_peer;
  if (of_peer >= most + more)
    return "the limit of " + std::to_string(most + more) + " sessions from one address is reached";
  return {};
}

std::size_t Server::Impl::count(bool (*of)(const WireSession&)) const {
  return static_cast<std::size_t>(std::count_if(sessions_.begin(), sessions_.end(),
                                                [of](const auto& entry) { return of(*entry.second); }));
}

void Server::Impl::count_open() {
  open_sessions_.store(count([](const WireSession& s) { return !s.closing(); }), std::memory_order_relaxed);
}

// ---------------------------------------- other threads

// One write wakes the server, however often signal() is called before it looks.
void Server::Impl::signal() {
  if (signalled_.exchange(true)) return;
  const std::uint64_t one = 1;
  // The write fails only if the counter is full, and then the server is awake.
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
  const bool stops = stop_asked_.load();
  if (notified_.exchange(false)) notify_handler();  // before sessions are told to close
  if (stops) begin_shutdown();
}

void Server::Impl::notify_handler() {
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
  listener_.close();
  if (local_) local_->close();
  if (http_) http_->close();
  for (auto& [id, session] : sessions_) session->close(CloseReason::kShutdown);
}

// ---------------------------------------- deadlines

void Server::Impl::arm_sweep() {
  if (sweeping_ || (sessions_.empty() && !(http_ && http_->busy()))) return;
  sweeping_ = true;
  last_sweep_ = steady_clock::now();
  sweep_timer_.expires_after(sweep_period_);
  sweep_timer_.async_wait([this](const error_code& error) {
    sweeping_ = false;
    if (!error) sweep();
  });
}

void Server::Impl::sweep() {
  // Time beyond two periods was not spent serving. No deadline runs while the server is busy elsewhere.
  context_.now += std::min<ServedTime>(steady_clock::now() - last_sweep_, 2 * sweep_period_);
  for (auto& [id, session] : sessions_) session->sweep();
  if (http_) http_->sweep();
  context_.address_logs.sweep();
  arm_sweep();
}

// ---------------------------------------- the loop

// Ends an event: tells the handler of closes, writes batches, frees finished sessions. Sessions that are
// woken meanwhile are handled, too.
// Short messages go first: a controller has begun its next cycle while a long sample is copied for someone
// else.
void Server::Impl::settle(Held held) {
  if (woken_.empty()) return;
  if (woken_.size() > 1)
    std::ranges::sort(woken_, {}, [](const WireSession* session) {
      return std::pair(session->bytes_to_send(), session->id());
    });
  bool any_closed = false;
  std::size_t stayed = 0;
  for (std::size_t i = 0; i < woken_.size(); ++i) {
    WireSession& session = *woken_[i];
    if (held == Held::kStay && session.held_back()) {
      woken_[stayed++] = &session;
      continue;
    }
    session.work();
    any_closed |= session.closing();
    if (!session.finished() || session.is_woken()) continue;
    talker_.forget(session);
    sessions_.erase(session.id());
  }
  woken_.resize(stayed);
  if (any_closed) count_open();
}

template <typename Run>
std::size_t Server::Impl::run_handlers(Run run) {
  try {
    return run(io_);
  } catch (const std::bad_alloc&) {
    spdlog::error("a connection is lost: not enough memory is left");
    return 1;
  }
}

// Waits for the next event, and handles it. What is held back leaves if there is none soon.
bool Server::Impl::wait(std::chrono::nanoseconds at_most) {
  const auto is_there = [&] {
    if (look_at_talker()) return true;
    return !talker_.takes_turn() && run_handlers([](auto& io) { return io.poll_one(); }) > 0;
  };
  if (busy_wait_.find(is_there, at_most)) return true;
  talker_.rest();
  const auto bound = woken_.empty() ? at_most : std::min<std::chrono::nanoseconds>(at_most, kNothingToDo);
  if (run_handlers([&](auto& io) { return io.run_one_for(bound); }) > 0) return true;
  settle();
  return false;
}

// Bounded, so that no client can keep the caller here.
bool Server::Impl::serve_ready() {
  bool any = look_at_talker();
  if (any) settle(Held::kStay);
  const std::size_t connections = http_ ? http_->connection_count() : 0;
  for (std::size_t left = sessions_.size() + connections + kSpareEvents; left > 0; --left) {
    if (run_handlers([](auto& io) { return io.poll_one(); }) == 0) break;
    any = true;
    settle(Held::kStay);
  }
  return any;
}

Server::Server(const ListenOptions& options, SessionHandler& handler)
    : impl_(std::make_unique<Impl>(options, handler)) {}

Server::~Server() = default;

std::uint16_t Server::port() const {
  return impl_->listener_.port();
}

std::uint16_t Server::http_port() const {
  return impl_->http_ ? impl_->http_->port() : 0;
}

void Server::start() {
  impl_->listener_.start();
  if (impl_->local_) impl_->local_->start();
  if (impl_->http_) impl_->http_->start();
}

void Server::run() {
  for (impl_->settle(); !impl_->over(); impl_->settle()) {
    impl_->talker_.rest();
    impl_->run_handlers([](auto& io) { return io.run_one(); });
  }
}

bool Server::poll() {
  impl_->settle(Impl::Held::kStay);
  return impl_->serve_ready();
}

void Server::poll_for(std::chrono::nanoseconds at_most) {
  const bool waits = at_most.count() > 0;
  impl_->settle(waits ? Impl::Held::kStay : Impl::Held::kLeave);
  if (waits && !impl_->wait(at_most)) return;
  impl_->settle(Impl::Held::kStay);
  // The talker mostly speaks alone. What came with it is seen at the next turn of all, or by poll().
  if (!waits || impl_->more_came_ || !impl_->talker_.takes_turn()) impl_->more_came_ = impl_->serve_ready();
}

void Server::write() {
  impl_->settle(Impl::Held::kStay);
}

void Server::stop() {
  impl_->stop_asked_.store(true);
  impl_->signal();
}

void Server::notify() {
  impl_->notified_.store(true);
  impl_->signal();
}

bool Server::ended() const {
  return impl_->over();
}

std::size_t Server::session_count() const {
  return impl_->open_sessions_.load(std::memory_order_relaxed);
}

std::uint64_t Server::refused() const {
  return impl_->context_.refused.load(std::memory_order_relaxed);
}

}  // namespace visum::protocol

#include "server/bus/bus_thread.h"

#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace visum::bus {

using powercube::BusFraming;
using powercube::Telegram;

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kRest{100};  // of a listener, once no descriptor is left

bool rests(const BusThread::Wiring& wiring) {
  return Clock::now() < wiring.rests_until;
}

}  // namespace

BusThread::BusThread(std::vector<Wiring> wirings, std::function<void()> on_request)
    : wirings_(std::move(wirings)),
      on_request_(std::move(on_request)),
      wake_fd_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (wake_fd_ < 0) throw std::runtime_error("eventfd: no descriptor left");
  for (std::uint32_t i = 0; i < wirings_.size(); ++i)
    for (auto& channel : wirings_[i].link->channels()) lines_[next_number_++] = {std::move(channel), i};
  thread_ = std::thread([this] { run(); });
}

BusThread::~BusThread() {
  ending_ = true;
  wake();
  thread_.join();
  ::close(wake_fd_);
}

void BusThread::flush() {
  const std::unique_lock turn(turn_, std::try_to_lock);
  if (!turn) return wake();
  send_answers();
  leave_rests();
}

void BusThread::wake() {
  const std::uint64_t one = 1;
  // This fails only where the counter is full, and then the thread is awake anyway.
  [[maybe_unused]] const auto written = ::write(wake_fd_, &one, sizeof one);
}

void BusThread::run() {
  while (!ending_) {
    rest_while_followed();
    wait();
    bool queued;
    {
      const std::lock_guard turn(turn_);
      serve(look());
      send_answers();
      count_dropped();
      queued = std::exchange(queued_, false);
    }
    if (queued) on_request_();
  }
}

std::vector<pollfd> BusThread::watched() const {
  std::vector<pollfd> set{{wake_fd_, POLLIN, 0}};
  for (const auto& wiring : wirings_)
    set.push_back({rests(wiring) ? -1 : wiring.link->listener(), POLLIN, 0});
  for (const auto& [number, line] : lines_) {
    const short events = line.channel->has_rest() ? POLLIN | POLLOUT : POLLIN;
    set.push_back({line.channel->fd(), events, 0});
  }
  return set;
}

void BusThread::wait() {
  std::unique_lock turn(turn_);
  const bool one_rests = std::ranges::any_of(wirings_, rests);
  auto set = watched();
  turn.unlock();
  ::poll(set.data(), set.size(), one_rests ? static_cast<int>(kRest.count()) : -1);
}

// settle() is there for what comes next, and a thread that woke up for each request would only be in its way.
void BusThread::rest_while_followed() {
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(followed_until_.load() - Clock::now());
    if (left.count() <= 0) return;
    pollfd woken{wake_fd_, POLLIN, 0};
    if (::poll(&woken, 1, static_cast<int>(left.count())) != 0) return;
  }
}

std::vector<pollfd> BusThread::look() const {
  auto set = watched();
  if (::poll(set.data(), set.size(), 0) < 0) return {};
  return set;
}

bool BusThread::serve(const std::vector<pollfd>& ready) {
  if (ready.empty()) return false;
  if (ready[0].revents) {
    std::uint64_t count = 0;
    [[maybe_unused]] const auto got = ::read(wake_fd_, &count, sizeof count);
  }
  bool any = false;
  auto of_line = ready.begin() + 1 + static_cast<std::ptrdiff_t>(wirings_.size());
  for (auto at = lines_.begin(); at != lines_.end();) {
    const auto line = at++;  // reading may end the line
    const auto revents = (of_line++)->revents;
    if (revents & POLLOUT) line->second.channel->flush();
    if (!(revents & ~POLLOUT)) continue;
    any = true;
    read(line->first, line->second);
  }
  for (std::uint32_t i = 0; i < wirings_.size(); ++i) {
    if (ready[1 + i].revents) any |= admit(i);
  }
  return any;
}

// poll() on a pseudo terminal first lets the kernel's worker carry over what was written to its other end, so
// nothing stays behind. TCP gives no such promise: there we wait for as many bytes as were written.
bool BusThread::settle(const std::vector<protocol::Stream>& streams, std::chrono::milliseconds patience) {
  const std::lock_guard turn(turn_);
  const auto begin = Clock::now();
  followed_until_ = begin + kFollowed;
  const auto within = [begin](auto time) { return Clock::now() < begin + time; };
  const auto lines = lines_.size();
  const auto newest = next_number_;
  const auto come = [this](const protocol::Stream& stream) { return has_come(stream); };
  bool all = false, missing = false;
  do {
    const bool may_connect =
        within(kGrace);  // asked before we look, so a late look still finds a client that has come
    while (within(patience) && serve(look())) {
    }
    if (!may_connect) missing |= give_up_missing(streams);
    all = std::ranges::all_of(streams, come);
  } while (!all && within(patience));
  queued_ = false;  // the caller asks for them now
  if (lines != lines_.size() || newest != next_number_) wake();
  leave_rests();
  return all && !missing;
}

bool BusThread::give_up_missing(const std::vector<protocol::Stream>& streams) {
  bool any = false;
  for (const auto& stream : streams)
    if (!channel_of(stream.port)) any |= gone_.insert(stream.port).second;
  return any;
}

bool BusThread::has_come(const protocol::Stream& stream) const {
  const auto* channel = channel_of(stream.port);
  return channel ? channel->heard() >= stream.written : gone_.contains(stream.port);
}

const Channel* BusThread::channel_of(std::uint32_t port) const {
  const auto found =
      std::ranges::find_if(lines_, [port](const auto& line) { return line.second.channel->port() == port; });
  return port == 0 || found == lines_.end() ? nullptr : found->second.channel.get();
}

void BusThread::send_now() {
  const std::lock_guard turn(turn_);
  send_answers();
  leave_rests();
}

void BusThread::leave_rests() {
  count_dropped();
  if (std::ranges::any_of(lines_, [](const auto& line) { return line.second.channel->has_rest(); })) wake();
}

void BusThread::count_dropped() {
  auto dropped = dropped_by_gone_;
  for (const auto& [number, line] : lines_) {
    if (line.channel->dropped() == 0) continue;
    dropped += line.channel->dropped();
    auto& wiring = wirings_[line.link];
    if (!std::exchange(wiring.warned_of_drops, true))
      spdlog::warn("{}: a client does not read what it is sent; frames and lines for it are dropped",
                   wiring.link->name());
  }
  dropped_.store(dropped, std::memory_order_relaxed);
}

std::uint64_t BusThread::said() {
  const std::lock_guard turn(turn_);
  std::uint64_t bytes = 0;
  for (const auto& [number, line] : lines_)
    if (line.channel->port() == 0) bytes += line.channel->written();
  return bytes;
}

void BusThread::fill_in(std::vector<protocol::Stream>& streams) {
  const std::lock_guard turn(turn_);
  for (auto& stream : streams)
    if (const auto* channel = channel_of(stream.port))
      stream = {stream.port, channel->written(), channel->heard()};
}

bool BusThread::admit(std::uint32_t link) {
  auto& wiring = wirings_[link];
  auto channel = wiring.link->accept();
  if (wiring.link->is_short()) {
    const bool is_new = wiring.rests_until == Clock::time_point{};
    if (is_new)
      spdlog::warn(
          "{}: a client waits to connect, but no file descriptor is left; raise the limit (ulimit -n)",
          wiring.link->name());
    wiring.rests_until = Clock::now() + kRest;
  } else if (channel) {
    wiring.rests_until = {};
  }
  const auto of_link = [link](const auto& entry) { return entry.second.link == link; };
  const auto count = static_cast<std::size_t>(std::ranges::count_if(lines_, of_link));
  if (!channel) return false;
  if (count == kMaxChannels) {
    gone_.insert(channel->port());
    return true;
  }
  gone_.erase(channel->port());
  lines_[next_number_++] = {std::move(channel), link};
  return true;
}

void BusThread::read(std::uint64_t number, OpenChannel& line) {
  const bool stays = line.channel->read(
      [&](const Telegram& telegram, BusFraming framing) { take(number, line, telegram, framing); });
  if (line.channel->client_discarded()) warn(wirings_[line.link]);
  if (stays) return;
  const auto& link = *wirings_[line.link].link;
  if (link.listener() < 0) spdlog::warn("the bus {} is gone", link.name());
  gone_.insert(line.channel->port());
  dropped_by_gone_ += line.channel->dropped();
  lines_.erase(number);
}

// A worker of the kernel carries what was written to a pseudo terminal over to us. If the client calls
// tcflush() before that worker ran, the kernel drops the bytes, and nothing on our side can save them.
void BusThread::warn(Wiring& wiring) {
  if (std::exchange(wiring.warned, true)) return;
  spdlog::warn(
      "{}: the client discards its own output (tcflush), which on a pseudo terminal can lose what it wrote "
      "just before; 'visum exec --tty' runs it without",
      wiring.link->name());
}

void BusThread::take(std::uint64_t number, const OpenChannel& line, const Telegram& telegram,
                     BusFraming framing) {
  if (framing == BusFraming::kCan) spread(wirings_[line.link].part, telegram, number);
  queued_ |= requests_.push({line.link, number, framing, telegram});
}

void BusThread::send_answers() {
  for (BusItem item; answers_.pop(item);) {
    if (item.framing == BusFraming::kCan) {
      if (!item.corrupted) spread(wirings_[item.link].part, item.telegram, 0);
    } else if (const auto line = lines_.find(item.channel); line != lines_.end()) {
      line->second.channel->send(item.telegram, item.corrupted);
    }
  }
}

void BusThread::spread(std::uint32_t part, const Telegram& telegram, std::uint64_t except) {
  for (auto& [number, line] : lines_)
    if (number != except && wirings_[line.link].part == part && line.channel->is_can())
      line.channel->send(telegram);
}

}  // namespace visum::bus

#include "server/gateway/bus/bus_thread.h"

#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace visum::gateway {

using powercube::Telegram;
using powercube::Wire;

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
  if (turn)
    send_answers();
  else
    wake();
}

void BusThread::wake() {
  const std::uint64_t one = 1;
  // Can fail only where the counter is full, and then the thread is awake.
  [[maybe_unused]] const auto written = ::write(wake_fd_, &one, sizeof one);
}

void BusThread::run() {
  while (!ending_) {
    const auto ready = wait();
    {
      const std::lock_guard turn(turn_);
      serve(ready);
      send_answers();
    }
    if (std::exchange(queued_, false)) on_request_();
  }
}

// For wake(), any listener, or any channel, in this order.
std::vector<pollfd> BusThread::wait() {
  std::vector<pollfd> set{{wake_fd_, POLLIN, 0}};
  for (const auto& wiring : wirings_) set.push_back({wiring.link->listener(), POLLIN, 0});
  for (const auto& [number, line] : lines_) set.push_back({line.channel->fd(), POLLIN, 0});
  if (::poll(set.data(), set.size(), -1) < 0) return {};
  return set;
}

void BusThread::serve(const std::vector<pollfd>& ready) {
  if (ready.empty()) return;
  if (ready[0].revents) {
    std::uint64_t count = 0;
    [[maybe_unused]] const auto got = ::read(wake_fd_, &count, sizeof count);
  }
  auto of_line = ready.begin() + 1 + static_cast<std::ptrdiff_t>(wirings_.size());
  for (auto at = lines_.begin(); at != lines_.end();) {
    const auto line = at++;  // reading may end the line
    if ((of_line++)->revents) read(line->first, line->second);
  }
  for (std::uint32_t i = 0; i < wirings_.size(); ++i)
    if (ready[1 + i].revents) admit(i);
}

void BusThread::admit(std::uint32_t link) {
  auto channel = wirings_[link].link->accept();
  const auto of_link = [link](const auto& entry) { return entry.second.link == link; };
  const auto count = static_cast<std::size_t>(std::ranges::count_if(lines_, of_link));
  if (channel && count < kMaxChannels) lines_[next_number_++] = {std::move(channel), link};
}

void BusThread::read(std::uint64_t number, Line& line) {
  const bool stays =
      line.channel->read([&](const Telegram& telegram, Wire wire) { take(number, line, telegram, wire); });
  if (line.channel->client_discarded()) warn(wirings_[line.link]);
  if (stays) return;
  const auto& link = *wirings_[line.link].link;
  if (link.listener() < 0) spdlog::warn("the bus {} is gone", link.name());
  lines_.erase(number);
}

// The kernel carries what was written to a pseudo terminal over to us in a worker of its own, and forgets it
// where the client's tcflush() comes before the worker: nothing that we do could save it.
void BusThread::warn(Wiring& wiring) {
  if (std::exchange(wiring.warned, true)) return;
  spdlog::warn(
      "{}: the client discards its own output (tcflush), which on a pseudo terminal can lose what it wrote "
      "just before; 'visum exec --tty' runs it without",
      wiring.link->name());
}

void BusThread::take(std::uint64_t number, const Line& line, const Telegram& telegram, Wire wire) {
  if (wire == Wire::kCan) spread(wirings_[line.link].part, telegram, number);
  queued_ |= requests_.push({line.link, number, wire, telegram});
}

void BusThread::send_answers() {
  for (BusItem item; answers_.pop(item);) {
    if (item.wire == Wire::kCan) {
      spread(wirings_[item.link].part, item.telegram, 0);
    } else if (const auto line = lines_.find(item.channel); line != lines_.end()) {
      line->second.channel->send(item.telegram);
    }
  }
}

void BusThread::spread(std::uint32_t part, const Telegram& telegram, std::uint64_t except) {
  for (auto& [number, line] : lines_)
    if (number != except && wirings_[line.link].part == part && line.channel->is_can())
      line.channel->send(telegram);
}

}  // namespace visum::gateway

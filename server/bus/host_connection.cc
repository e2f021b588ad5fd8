#include "server/bus/host_connection.h"

#include <poll.h>
#include <spdlog/spdlog.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <stdexcept>

#include "server/bus/host_devices.h"

namespace visum::bus {
namespace {

using powercube::BusFraming;
using powercube::Telegram;

constexpr std::int64_t kTryAgain_ns = 500'000'000;
constexpr std::size_t kMostReceived = 1024;  // telegrams; more are dropped

struct HostKind {
  const char* name;
  BusFraming framing;
  std::unique_ptr<Channel> (*open)(const std::string& where);
};
constexpr HostKind kHostKinds[] = {
    {"serial", BusFraming::kSerial, open_serial_device},
    {"tcp", BusFraming::kSerial, connect_to_bus},
    {"slcan", BusFraming::kCan, open_slcan_device},
    {"socketcan", BusFraming::kCan, open_can_interface},
};

class HostConnection : public powercube::BusConnection {
 public:
  HostConnection(const HostKind& kind, std::string where)
      : kind_(kind), where_(std::move(where)), channel_(kind.open(where_)) {}

  std::string name() const override { return std::string(kind_.name) + ":" + where_; }
  BusFraming framing() const override { return kind_.framing; }

  bool up() const override { return channel_ != nullptr; }

  void send(const Telegram& telegram) override {
    if (channel_) channel_->send(telegram);
  }

  std::optional<Telegram> receive() override {
    if (received_.empty()) read();
    if (received_.empty()) return std::nullopt;
    const auto telegram = received_.front();
    received_.pop_front();
    return telegram;
  }

  std::int64_t now_ns() const override {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
  }

  void wait_until(std::int64_t due_ns) override {
    const auto left = std::max<std::int64_t>(0, due_ns - now_ns());
    const timespec wait{static_cast<time_t>(left / 1'000'000'000), static_cast<long>(left % 1'000'000'000)};
    const short events = channel_ && channel_->has_rest() ? POLLIN | POLLOUT : POLLIN;
    pollfd line{channel_ ? channel_->fd() : -1, events, 0};
    ::ppoll(&line, 1, &wait, nullptr);
  }

 private:
  void read() {
    if (!channel_) reopen();
    if (!channel_) return;
    channel_->flush();
    const auto keep = [this](const Telegram& telegram, BusFraming) {
      if (received_.size() < kMostReceived) received_.push_back(telegram);
    };
    if (channel_->read(keep)) return;
    spdlog::error("{} is gone", name());
    channel_.reset();
    tried_ns_ = now_ns();
  }

  void reopen() {
    if (now_ns() - tried_ns_ < kTryAgain_ns) return;
    tried_ns_ = now_ns();
    try {
      channel_ = kind_.open(where_);
      spdlog::info("{} is there again", name());
    } catch (const std::runtime_error& error) {
      spdlog::debug("{}", error.what());
    }
  }

  const HostKind& kind_;
  std::string where_;
  std::unique_ptr<Channel> channel_;  // none while the device is gone
  std::int64_t tried_ns_ = 0;
  std::deque<Telegram> received_;
};

}  // namespace

std::unique_ptr<powercube::BusConnection> open_host_connection(const std::string& text) {
  const auto colon = text.find(':');
  const auto kind = std::ranges::find_if(kHostKinds, [&](const HostKind& row) {
    return colon != std::string::npos && text.substr(0, colon) == row.name;
  });
  if (kind == std::end(kHostKinds) || colon + 1 == text.size())
    throw std::runtime_error("'" + text +
                             "' is no bus: it must be serial:DEVICE,BAUD, tcp:HOST:PORT, slcan:DEVICE or "
                             "socketcan:INTERFACE");
  return std::make_unique<HostConnection>(*kind, text.substr(colon + 1));
}

}  // namespace visum::bus

// The host's end of a bus that leads straight into a virtual part's modules. It has no device, its clock is
// ticked by the test, and it loses or refuses what the test sets below.
#pragma once

#include <algorithm>
#include <deque>
#include <functional>
#include <set>

#include "hwparts/part.h"
#include "hwparts/powercube/bus_connection.h"
#include "hwparts/powercube/module_bus.h"

namespace visum::test {

class PluggedConnection : public powercube::BusConnection {
 public:
  // `tick` is called while the program waits. It lets a tick of the virtual part's time pass.
  PluggedConnection(hwparts::Part& part, powercube::BusFraming framing, std::function<void()> tick,
                    double tick_s)
      : part_(part),
        framing_(framing),
        tick_(std::move(tick)),
        tick_ns_(static_cast<std::int64_t>(tick_s * 1e9)) {}

  std::string name() const override { return "plugged"; }
  powercube::BusFraming framing() const override { return framing_; }
  bool up() const override { return !gone; }
  void send(const powercube::Telegram& telegram) override {
    sent.push_back(telegram);
    if (gone || cut || silent.contains(telegram.module)) return;
    if (deaf_to != 0 && telegram.message.command() == 0x08 && telegram.message.data[1] == deaf_to) return;
    if (lose_next > 0 && lose_next-- > 0) return;
    if (refuses(telegram.message)) {
      const auto& message = telegram.message;
      const powercube::Message refusal{message.data[0], message.data[1], 0x00};
      answers_.push_back({powercube::Telegram::Kind::kAnswer, telegram.module, refusal});
      return;
    }
    if (const auto answer = part_.modules()->handle(telegram, framing_)) answers_.push_back(*answer);
  }
  std::optional<powercube::Telegram> receive() override {
    if (answers_.empty() || cut) return std::nullopt;
    const auto first = answers_.front();
    answers_.pop_front();
    return first;
  }
  std::int64_t now_ns() const override { return now_ns_; }
  void wait_until(std::int64_t due_ns) override {
    while (now_ns_ < due_ns && answers_.empty()) tick_();
  }
  void pass_tick() { now_ns_ += tick_ns_; }

  int count(std::uint8_t command) const {
    const auto is = [command](const auto& telegram) { return telegram.message.command() == command; };
    return static_cast<int>(std::ranges::count_if(sent, is));
  }

  bool gone = false;         // the device is gone
  bool cut = false;          // the cable is cut
  std::set<int> silent;      // these modules do not answer
  std::uint8_t deaf_to = 0;  // SETPARAM of this parameter is lost
  int lose_next = 0;         // this many requests are lost
  int refuse_moves = 0;      // this many SETMOVE are refused
  std::uint8_t refused = 0;  // SETPARAM of this parameter is refused
  std::deque<powercube::Telegram> sent;

 private:
  bool refuses(const powercube::Message& message) {
    if (message.command() == powercube::command::kSetMove) return refuse_moves > 0 && refuse_moves-- > 0;
    return message.command() == powercube::command::kSetParameter && refused != 0 &&
           message.data[1] == refused;
  }

  hwparts::Part& part_;
  powercube::BusFraming framing_;
  std::function<void()> tick_;
  std::int64_t tick_ns_;
  std::int64_t now_ns_ = 1;
  std::deque<powercube::Telegram> answers_;
};

}  // namespace visum::test

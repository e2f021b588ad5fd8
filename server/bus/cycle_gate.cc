#include "server/bus/cycle_gate.h"

#include <algorithm>

namespace visum::bus {
namespace {

constexpr std::size_t kKeyBytes = 2;  // the command, and its parameter or kind of motion

}  // namespace

void CycleGate::ask(const BusItem& request) {
  if (requests_.size() < kQueue) requests_.push_back(request);
}

std::optional<BusItem> CycleGate::next(std::int64_t tick) {
  if (tick < granted_tick_ || requests_.empty()) return std::nullopt;
  const BusItem request = requests_.front();
  if (rule_.frame.empty()) {
    auto key = key_of(request.telegram);
    if (!std::exchange(paid_, false) && asked_.contains(key)) {
      asked_.clear();
      granted_tick_ = tick + rule_.period_ticks;
      paid_ = true;
      return std::nullopt;
    }
    asked_.insert(std::move(key));
  } else if (is_named(request.telegram)) {
    granted_tick_ = tick + rule_.period_ticks;
  }
  requests_.pop_front();
  return request;
}

std::vector<CycleGate::Answer> CycleGate::released(std::int64_t tick) {
  return tick < granted_tick_ ? std::vector<Answer>() : std::exchange(answers_, {});
}

CycleGate::Key CycleGate::key_of(const powercube::Telegram& telegram) {
  const auto bytes = telegram.message.bytes();
  const auto first = bytes.first(std::min(bytes.size(), kKeyBytes));
  return {telegram.module, {first.begin(), first.end()}};
}

bool CycleGate::is_named(const powercube::Telegram& telegram) const {
  const auto bytes = telegram.message.bytes();
  return telegram.module == rule_.module && bytes.size() >= rule_.frame.size() &&
         std::ranges::equal(rule_.frame, bytes.first(rule_.frame.size()));
}

}  // namespace visum::bus

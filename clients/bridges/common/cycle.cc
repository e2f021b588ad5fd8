#include "clients/bridges/common/cycle.h"

#include <algorithm>
#include <tuple>

#include "clients/visum/common/exit_code.h"
#include "protocol/config/unknown_name.h"

namespace visum::bridge {

Cycle::Cycle(Plant& plant, std::int64_t period_ns, const std::vector<std::string>& gates)
    : plant_(plant), period_ns_(period_ns) {
  if (plant.client().server().clock != "lockstep") {
    throw Error(ErrorCode::kWrongState, "--lockstep: the server's clock is " + plant.client().server().clock +
                                            "; start it with --clock lockstep");
  }
  std::vector<std::string> names;
  for (const Part& part : plant.parts()) {
    for (const PortInfo& port : part.input_ports()) names.push_back(part.name() + "/" + port.name);
  }
  for (const std::string& gate : gates) {
    if (std::find(names.begin(), names.end(), gate) == names.end()) {
      throw cli::ExitError(cli::kUsage, "--gate: " + config::unknown_name("controller input", gate, names));
    }
    gates_[gate] = false;
  }
  plant_.client().join();
}

std::string Cycle::latch(Message message) {
  if (messages_.size() >= kMostMessages) {
    return "more than " + std::to_string(kMostMessages) + " messages wait for this cycle to end";
  }
  if (const auto gate = gates_.find(message.name); gate != gates_.end()) gate->second = true;
  messages_.push_back(std::move(message));
  return {};
}

std::string Cycle::ask_for_steps(std::int64_t count) {
  if (count < 1 || count > kMostSteps - steps_) {
    return "at least 1 and at most " + std::to_string(kMostSteps) + " cycles can be asked for";
  }
  steps_ += count;
  return {};
}

bool Cycle::is_complete() const {
  if (steps_ > 0) return true;
  return !gates_.empty() && std::all_of(gates_.begin(), gates_.end(), [](auto& gate) { return gate.second; });
}

// The order is by client and name; messages of one client for one port stay in the order of their sending.
void Cycle::act() {
  std::stable_sort(messages_.begin(), messages_.end(), [](const Message& a, const Message& b) {
    return std::tie(a.client, a.name) < std::tie(b.client, b.name);
  });
  for (const Message& message : messages_) message.act();
  messages_.clear();
  for (auto& gate : gates_) gate.second = false;
  if (steps_ > 0) --steps_;
}

bool Cycle::work() {
  if (running_) {
    running_ = !plant_.client().advanced(std::chrono::milliseconds(1));
    return !running_;
  }
  if (!is_complete()) return false;
  act();
  plant_.client().begin_advance_ns(period_ns_);
  running_ = true;
  return false;
}

}  // namespace visum::bridge

#include "hwparts/powercube/asker.h"

#include <algorithm>
#include <limits>

namespace visum::powercube {
namespace {

bool has_parameter(const Message& request) {
  const auto command = request.command();
  return command == command::kGetParameter || command == command::kSetParameter ||
         command == command::kSetMove;
}

bool answers(const Message& request, const Message& answer) {
  if (answer.size == 0 || answer.command() != request.command()) return false;
  return !has_parameter(request) || (answer.size > 1 && answer.data[1] == request.data[1]);
}

}  // namespace

bool Asker::may_ask(int module) const {
  if (line_.framing() == BusFraming::kSerial) return count_ == 0;
  return !out_[static_cast<std::size_t>(module)].waits;
}

void Asker::ask(int module, const Message& request, const std::optional<Patience>& patience) {
  const auto& limits = patience ? *patience : patience_;
  out_[static_cast<std::size_t>(module)] = {true, request, 0, limits.answer_ns, limits.tries};
  ++count_;
  send(module);
}

void Asker::send(int module) {
  auto& out = out_[static_cast<std::size_t>(module)];
  --out.tries_left;
  out.due_ns = line_.now_ns() + out.answer_ns;
  const bool reads = out.request.command() == command::kGetParameter;
  line_.send(
      {reads ? Telegram::Kind::kGet : Telegram::Kind::kSet, static_cast<std::uint8_t>(module), out.request});
}

void Asker::tell_all(const Message& message) {
  line_.send({Telegram::Kind::kBroadcast, 0, message});
}

std::optional<Asker::Outcome> Asker::next() {
  while (const auto telegram = line_.receive()) {
    if (telegram->kind != Telegram::Kind::kAnswer || telegram->module > kMaxModule) continue;
    auto& out = out_[telegram->module];
    if (!out.waits || !answers(out.request, telegram->message)) continue;
    out.waits = false;
    --count_;
    return Outcome{telegram->module, out.request, telegram->message};
  }
  const auto now = line_.now_ns();
  for (int module = 1; module <= kMaxModule && count_ > 0; ++module) {
    auto& out = out_[static_cast<std::size_t>(module)];
    if (!out.waits || now < out.due_ns) continue;
    if (out.tries_left > 0) {
      send(module);
      continue;
    }
    out.waits = false;
    --count_;
    return Outcome{module, out.request, std::nullopt};
  }
  return std::nullopt;
}

std::optional<Message> Asker::ask_and_wait(int module, const Message& request,
                                           const std::optional<Patience>& patience) {
  ask(module, request, patience);
  for (;;) {
    if (auto outcome = next()) return outcome->answer;
    line_.wait_until(next_due_ns());
  }
}

void Asker::forget() {
  for (auto& out : out_) out.waits = false;
  count_ = 0;
}

std::int64_t Asker::next_due_ns() const {
  auto due = std::numeric_limits<std::int64_t>::max();
  for (const auto& out : out_)
    if (out.waits) due = std::min(due, out.due_ns);
  return due;
}

}  // namespace visum::powercube

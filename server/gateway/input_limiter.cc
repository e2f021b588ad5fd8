#include "server/gateway/input_limiter.h"

#include <string>

namespace visum::gateway {

using protocol::ErrorCode;

bool InputLimiter::has_sent_enough(std::uint64_t session, std::int64_t tick) {
  const auto found = sent_.find(session);
  if (found == sent_.end()) return false;
  auto& sent = found->second;
  if (sent.tick != tick) sent = {tick, 0};
  return sent.inputs >= (realtime_ ? kMaxPerTick : kMaxSingleWrites);
}

void InputLimiter::count(std::uint64_t session, std::int64_t tick) {
  auto& sent = sent_[session];
  if (sent.tick != tick) sent = {tick, 0};
  ++sent.inputs;
}

Input* InputLimiter::blank_or_fail(const Call& call) {
  if (has_sent_enough(call.session.id(), call.now.tick) && realtime_) {
    call.fail(ErrorCode::kBusy, "more than " + std::to_string(kMaxPerTick) + " inputs within one tick");
    return nullptr;
  }
  count(call.session.id(), call.now.tick);
  auto* input = mailbox_.blank_input();
  if (!input) call.fail(ErrorCode::kBusy, kTooManyInputs);
  return input;
}

Input* InputLimiter::urgent_blank_or_fail(const Call& call) {
  auto* input = mailbox_.blank_input(true);
  if (!input) call.fail(ErrorCode::kBusy, kTooManyInputs);
  return input;
}

// FNV-1a.
std::uint64_t order_of(const Call& call) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (unsigned char c : call.session.client_name()) hash = (hash ^ c) * 0x100000001b3u;
  return hash;
}

}  // namespace visum::gateway

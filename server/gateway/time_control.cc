#include "server/gateway/time_control.h"

#include <algorithm>
#include <string>

namespace visum::gateway {

using protocol::ErrorCode;

namespace {

constexpr std::size_t kMostNameBytes = 64;

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

// The names of files that clients ask for: no path can be made of them.
bool is_name(const std::string& name) {
  return !name.empty() && name.size() <= kMostNameBytes && is_letter(name.front()) &&
         std::ranges::all_of(
             name, [](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-'; });
}

void fail_name(const Call& call) {
  call.fail(ErrorCode::kBadValue,
            "a name begins with a letter; letters, digits, '_' and '-' follow, 64 bytes in all");
}

}  // namespace

void TimeControl::handle(const Call& call, const protocol::TakeSnapshot& request) {
  if (!request.name.empty() && !is_name(request.name)) return fail_name(call);
  commands_.send(call, request);
}

void TimeControl::handle(const Call& call, const protocol::RestoreSnapshot& request) {
  if (!request.name.empty() && !is_name(request.name)) return fail_name(call);
  if (!request.name.empty() && request.snapshot != 0)
    return call.fail(ErrorCode::kBadValue, "a snapshot has a number or a name, not both");
  commands_.send(call, request);
}

void TimeControl::handle(const Call& call, const protocol::StartRecording& request) {
  if (!is_name(request.name)) return fail_name(call);
  commands_.send(call, request);
}

void TimeControl::handle(const Call& call, const protocol::Step& request) {
  constexpr std::int64_t kMostSteps = 1'000'000'000;
  if (request.ticks < 1 || request.ticks > kMostSteps)
    return call.fail(ErrorCode::kBadValue, "ticks must be within 1 and " + std::to_string(kMostSteps));
  commands_.send(call, request);
}

void TimeControl::handle(const Call& call, const protocol::SetSpeed& request) {
  if (world_.clock != scene::ClockKind::kRealtime)
    return call.fail(ErrorCode::kWrongState, "the clock is " + std::string(scene::name_of(world_.clock)) +
                                                 "; only realtime has a speed");
  if (!(request.factor >= scene::kLeastSpeed && request.factor <= scene::kMostSpeed))
    return call.fail(ErrorCode::kBadValue, "the speed must be within 0.001 and 1000");
  commands_.send(call, request);
}

}  // namespace visum::gateway

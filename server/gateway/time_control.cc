#include "server/gateway/time_control.h"

#include <string>

#include "server/gateway/plain_name.h"

namespace visum::gateway {

using protocol::ErrorCode;

namespace {

void fail_name(const Call& call) {
  call.fail(ErrorCode::kBadValue, kPlainNameRule);
}

}  // namespace

void TimeControl::handle(const Call& call, const protocol::TakeSnapshot& request) {
  if (!request.name.empty() && !is_plain_name(request.name)) return fail_name(call);
  commands_.send(call, request);
}

void TimeControl::handle(const Call& call, const protocol::RestoreSnapshot& request) {
  if (!request.name.empty() && !is_plain_name(request.name)) return fail_name(call);
  if (!request.name.empty() && request.snapshot != 0)
    return call.fail(ErrorCode::kBadValue, "a snapshot has a number or a name, not both");
  commands_.send(call, request);
}

void TimeControl::handle(const Call& call, const protocol::StartRecording& request) {
  if (!is_plain_name(request.name)) return fail_name(call);
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

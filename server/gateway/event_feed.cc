#include "server/gateway/event_feed.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "protocol/config/printable.h"

namespace visum::gateway {
namespace {

using protocol::EventLevel;

EventLevel level_of(std::string_view kind) {
  constexpr std::array<std::string_view, 6> kWarnings{"lease_lost",    "lockstep_timeout", "push_refused",
                                                      "fault_refused", "emergency_stop",   "events_lost"};
  if (kind == "frozen") return EventLevel::kError;
  return std::ranges::find(kWarnings, kind) != kWarnings.end() ? EventLevel::kWarning : EventLevel::kInfo;
}

}  // namespace

bool EventFeed::has_room(Clock::time_point now) {
  if (lost_ == 0 && bucket_.take(now)) return true;
  ++lost_;
  return false;
}

std::uint64_t EventFeed::take_lost(Clock::time_point now) {
  if (lost_ == 0 || !bucket_.take(now)) return 0;
  return std::exchange(lost_, 0);
}

void EventFeed::keep(protocol::Event& event) {
  if (event.level == EventLevel::kUnspecified) event.level = level_of(event.kind);
  if (event.source.empty()) event.source = event.part.empty() ? program_ : event.part;
  event.sim_time_ns = event.tick * tick_ns_;
  event.text = config::shortened(std::move(event.text), kMostBytes);
  if (kept_.size() == kMostKept) kept_.pop_front();
  kept_.push_back(event);
}

protocol::EventList EventFeed::kept(EventLevel least) const {
  protocol::EventList list;
  for (const auto& event : kept_)
    if (event.level >= least) list.events.push_back(event);
  return list;
}

}  // namespace visum::gateway

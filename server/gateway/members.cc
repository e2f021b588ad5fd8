#include "server/gateway/members.h"

#include <algorithm>
#include <limits>

namespace visum::gateway {

Member* Members::find(std::uint64_t session) {
  const auto found = std::ranges::find(members_, session, &Member::session);
  return found == members_.end() ? nullptr : &*found;
}

bool Members::is_member(std::uint64_t session) const {
  return std::ranges::find(members_, session, &Member::session) != members_.end();
}

Member& Members::join(std::uint64_t session, const std::string& client, std::int64_t tick,
                      std::chrono::nanoseconds timeout) {
  end_waits();  // while a member was alone, waiting for it did not count
  auto& member = members_.emplace_back();
  member.session = session;
  member.client = client;
  member.granted_tick = tick;
  member.timeout = timeout;
  return member;
}

bool Members::leave(std::uint64_t session) {
  return std::erase_if(members_, [session](const Member& member) { return member.session == session; }) > 0;
}

std::int64_t Members::limit() const {
  std::int64_t limit = std::numeric_limits<std::int64_t>::max();
  for (const auto& member : members_) limit = std::min(limit, member.granted_tick);
  return limit;
}

bool Members::others_hold(const Member& one, std::int64_t tick) const {
  return std::ranges::any_of(members_, [&](const Member& member) {
    return &member != &one && !member.after && member.granted_tick <= tick;
  });
}

const Member* Members::held_by(std::int64_t tick) const {
  const Member* holder = nullptr;
  for (const auto& member : members_)
    if (member.granted_tick <= tick) holder = &member;
  return holder;
}

std::optional<std::int64_t> Members::next_answer() const {
  std::optional<std::int64_t> next;
  for (const auto& member : members_) {
    if (!member.advance) continue;
    const auto answer = member.granted_tick + (member.after ? member.after->ticks : 0);
    next = next ? std::min(*next, answer) : answer;
  }
  return next;
}

void Members::end_waits() {
  for (auto& member : members_) member.waited_since.reset();
}

void Members::rebase(std::int64_t tick) {
  for (auto& member : members_) member.granted_tick = tick;
}

Member* Members::waited_too_long(std::int64_t tick, Member::Clock::time_point now) {
  Member* late = nullptr;
  const bool alone = members_.size() == 1;
  for (auto& member : members_) {
    if (member.granted_tick > tick) {
      member.waited_since.reset();
      continue;
    }
    if (!member.waited_since) member.waited_since = now;
    const bool patient = (alone && !member.own_timeout) || member.timeout.count() == 0 ||
                         member.on_timeout == protocol::OnTimeout::kHold;
    if (!late && !patient && now - *member.waited_since > member.timeout) late = &member;
  }
  return late;
}

}  // namespace visum::gateway

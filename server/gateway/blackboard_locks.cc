#include "server/gateway/blackboard_locks.h"

namespace visum::gateway {

using protocol::ErrorCode;

namespace {

BlackboardLocks::Refusal over(const std::string& name) {
  return {{ErrorCode::kTimeout, "the lock of '" + name +
                                    "' has ended: its time-out passed, or the world was reset; "
                                    "what was written under it was dropped"}};
}

// Counts what a write takes in memory, so that empty ones have a limit, too.
std::size_t bytes_of(const protocol::WriteBlackboard& write) {
  return sizeof write + write.part.size() + write.name.size() + write.data.size();
}

}  // namespace

BlackboardLocks::Lock* BlackboardLocks::find(std::uint64_t session, const std::string& part,
                                             const std::string& name) {
  const auto found = locks_.find({part, name});
  return found == locks_.end() || found->second.session != session ? nullptr : &found->second;
}

// Another session's lock is over: this session has the part's lease now.
BlackboardLocks::Refusal BlackboardLocks::lock(std::uint64_t session, const protocol::LockBlackboard& request,
                                               std::int64_t timeout_ticks, const Published& now) {
  if (request.timeout_ns < 1 || request.timeout_ns > kMostTimeout_ns)
    return {{ErrorCode::kBadValue, "timeout_ns must be within 1 and 60e9"}};
  const Lock* const own = find(session, request.part, request.name);
  if (own != nullptr && !own->is_over(now))
    return {{ErrorCode::kWrongState, "this session has locked '" + request.name + "' already"}};
  locks_[{request.part, request.name}] = {session, now.era, now.tick + timeout_ticks};
  return {};
}

bool BlackboardLocks::keep(std::uint64_t session, const protocol::WriteBlackboard& write,
                           const Published& now, Refusal& refusal) {
  Lock* const lock = find(session, write.part, write.name);
  if (lock == nullptr) return false;
  if (lock->is_over(now)) {
    refusal = over(write.name);
  } else if (const auto bytes = bytes_of(write); bytes > kMostBytes - lock->bytes) {
    refusal = {{ErrorCode::kBusy, "more than " + std::to_string(kMostBytes) + " bytes under one lock"}};
  } else {
    lock->bytes += bytes;
    lock->writes.push_back(write);
  }
  return true;
}

std::vector<protocol::WriteBlackboard> BlackboardLocks::unlock(std::uint64_t session,
                                                               const protocol::UnlockBlackboard& request,
                                                               const Published& now, Refusal& refusal) {
  const Lock* const lock = find(session, request.part, request.name);
  if (lock == nullptr) {
    refusal = {{ErrorCode::kWrongState, "this session has not locked '" + request.name + "'"}};
    return {};
  }
  if (lock->is_over(now) && !request.discard) refusal = over(request.name);
  auto node = locks_.extract({request.part, request.name});
  if (refusal || request.discard) return {};
  return std::move(node.mapped().writes);
}

}  // namespace visum::gateway

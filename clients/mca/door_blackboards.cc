// The requests about blackboards at a part's own port.
#include <algorithm>

#include "clients/mca/door.h"
#include "clients/mca/part.h"
#include "protocol/config/unknown_name.h"

namespace visum::mca {

Blackboard* Door::blackboard(Peer& peer, std::uint64_t id, const std::string& name) {
  const auto& boards = part_.blackboards();
  const auto found = std::ranges::find(boards, name, [](const Blackboard* board) { return board->name(); });
  if (found != boards.end()) return *found;
  std::vector<std::string> names;
  for (const Blackboard* known : boards) names.push_back(known->name());
  fail(peer, id, protocol::ErrorCode::kUnknownName, config::unknown_name("blackboard", name, names));
  return nullptr;
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::ReadBlackboard& request) {
  if (!is_ours(peer, id, request.part)) return;
  const Blackboard* board = blackboard(peer, id, request.name);
  if (board == nullptr) return;
  const auto bytes = board->bytes();
  if (request.offset > bytes.size())
    return fail(peer, id, protocol::ErrorCode::kBadValue,
                "'" + request.name + "' has " + std::to_string(bytes.size()) + " bytes");
  const auto rest = bytes.subspan(request.offset);
  const auto wanted =
      request.length == 0 ? rest : rest.first(std::min<std::size_t>(request.length, rest.size()));
  done(peer, id,
       protocol::BlackboardData{
           request.offset, bytes.size(), {wanted.begin(), wanted.end()}, board->generation()});
}

void Door::handle(Peer& peer, std::uint64_t id, const protocol::WriteBlackboard& request) {
  if (!is_ours(peer, id, request.part)) return;
  Blackboard* board = blackboard(peer, id, request.name);
  if (board == nullptr || !has_lease(peer, id)) return;
  const std::string why = board->options().writable ? board->write(request.data, request.offset)
                                                    : "'" + request.name + "' is read-only";
  if (!why.empty()) return fail(peer, id, protocol::ErrorCode::kBadValue, why);
  written_ns_ = time_ns_;
  done(peer, id);
}

}  // namespace visum::mca

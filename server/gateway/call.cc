#include "server/gateway/call.h"

#include <vector>

#include "protocol/config/unknown_name.h"

namespace visum::gateway {

using protocol::ErrorCode;

void Call::reply(const protocol::Reply& reply) const {
  if (id != 0) session.send(id, reply);
}

void Call::fail(ErrorCode code, const std::string& text, const std::string& owner) const {
  clients.count_refusal();
  if (code == ErrorCode::kForbidden)
    session.log(protocol::LogLevel::kWarning,
                "'" + session.client_name() + "' at " + session.peer() + " is refused: " + text);
  session.send(id, protocol::Error{code, text, owner});
}

std::optional<std::uint32_t> part_or_fail(const Call& call, const StaticWorld& world,
                                          const std::string& name) {
  std::vector<std::string> known;
  for (std::uint32_t part = 0; part < world.parts.size(); ++part) {
    if (world.part_name(part).empty()) continue;
    known.push_back(world.part_name(part));
    if (known.back() == name) return part;
  }
  call.fail(ErrorCode::kUnknownName, config::unknown_name("part", name, known));
  return {};
}

}  // namespace visum::gateway

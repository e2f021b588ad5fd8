// Checks of a Hello that need no knowledge of the world: version, role and name. Pure function, any thread.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "protocol/messages.h"

namespace visum::protocol {

inline constexpr std::size_t kMaxClientName = 64;  // bytes

// Returns nothing if the hello is good; `version` is then the highest that both sides speak. Otherwise
// returns the refusal to send.
std::optional<Error> refuse_hello(const Hello& hello, std::uint32_t& version);

}  // namespace visum::protocol

// The checks of a Hello that need no knowledge of the world: version, role, name. Pure.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "protocol/messages.h"

namespace visum::protocol {

inline constexpr std::size_t kMaxClientName = 64;  // bytes

// Nothing if the hello is good; `version` is then the highest that both sides speak.
std::optional<Error> refuse_hello(const Hello& hello, std::uint32_t& version);

}  // namespace visum::protocol

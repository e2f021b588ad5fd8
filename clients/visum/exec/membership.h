// Being a member of a server's lockstep on behalf of a program.
#pragma once

#include <optional>
#include <string>

#include "protocol/client.h"

namespace visum::exec {

// Throws ExitError(kUsage) where the server's clock is not lockstep, or it refuses what `request` asks for.
protocol::Advanced join(protocol::Connection& connection, const protocol::Join& request);
// The program has ended by itself: its parts go on with what it told them last. Where it is not said (it
// crashed, or we are gone) they stop.
void leave(protocol::Connection& connection);
// Takes the server's events in. If we were late and are a member no longer, why.
std::optional<std::string> why_thrown_out(protocol::Connection& connection);
// On stderr: from now on the program goes on in real time.
void say_dropped(const std::string& why);

}  // namespace visum::exec

// Joins and leaves a server's lockstep on behalf of a program.
#pragma once

#include <optional>
#include <string>

#include "protocol/client.h"

namespace visum::exec {

// Throws ExitError(kUsage) where the server's clock is not lockstep, or it refuses what `request` asks for.
protocol::Advanced join(protocol::Connection& connection, const protocol::Join& request);
// For a program that has ended by itself: its parts go on with its last commands. Without this call (the
// program crashed, or we did) they stop.
void leave(protocol::Connection& connection);
// Reads the server's events. Returns the reason where we were late and are no longer a member.
std::optional<std::string> why_thrown_out(protocol::Connection& connection);
// As above, by the events that came with earlier answers. Asks the kernel nothing.
std::optional<std::string> why_thrown_out_by_now(protocol::Connection& connection);
// Says on stderr that the program goes on in real time from now on.
void say_dropped(const std::string& why);

}  // namespace visum::exec

// Reads the token that a server asks for. Clients use it; a mirror is one of them.
#pragma once

#include <string>

#include "protocol/messages.h"

namespace visum::protocol {

// Returns the token for `role`. A line holds a token alone, or (as in the server's own file) "ROLE TOKEN".
// The first line with a token alone wins. Otherwise the token of the least role that suffices is taken, and
// if none suffices, that of the greatest role. # begins a comment. An empty file name gives no token. Throws
// std::runtime_error that names the file.
std::string read_token_file(const std::string& file, Role role);

}  // namespace visum::protocol

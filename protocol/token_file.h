// Where a client (a mirror is one, too) finds the token that a server asks for.
#pragma once

#include <string>

#include "protocol/messages.h"

namespace visum::protocol {

// The token for `role`: the first line that is a token alone or, in a file as the server's own with lines of
// "ROLE TOKEN", that of the least role that is enough (else of the greatest there is). # begins a comment. No
// file name: no token. Throws std::runtime_error that names the file.
std::string read_token_file(const std::string& file, Role role);

}  // namespace visum::protocol

// Opens a session by the options that every connecting verb has, and looks parts up by name.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "protocol/client.h"
#include "protocol/messages.h"

namespace visum::cli {

struct LinkOptions {
  std::string connect = "127.0.0.1:1500";
  std::string token_file;
  protocol::TlsFiles tls;
  bool json = false;
};

// The token for this role, and the server's host and port. Throw ExitError(kUsage).
std::string read_token(const LinkOptions& options, protocol::Role role);
std::pair<std::string, std::uint16_t> server_of(const LinkOptions& options);

// Throws ExitError(kUsage) for a wrong address or token file, ConnectionError if no server answers,
// RequestError if it refuses us.
protocol::Connection open_link(const LinkOptions& options, protocol::Role role,
                               const std::string& client_name = "visum");

// Throws ExitError(kUsage) for an unknown part; the message suggests the nearest.
protocol::PartDescriptionReply describe_part(protocol::Connection& link, const std::string& part);

}  // namespace visum::cli

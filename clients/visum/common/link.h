// From the options that every connecting verb has to a session, and from names to what the server calls them.
#pragma once

#include <string>
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

// Throws ExitError: kUsage for a wrong address, kLost where nobody answers, kFailed where the server refuses.
protocol::Connection open_link(const LinkOptions& options, protocol::Role role,
                               const std::string& client_name = "visum");

// Throws ExitError(kUsage) that names the nearest part.
protocol::PartDescriptionReply describe_part(protocol::Connection& link, const std::string& part);

}  // namespace visum::cli

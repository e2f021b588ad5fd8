#include "clients/visum/common/link.h"

#include <algorithm>

#include "clients/visum/common/exit_code.h"
#include "protocol/config/config.h"
#include "protocol/config/unknown_name.h"
#include "protocol/limits.h"
#include "protocol/token_file.h"

namespace visum::cli {

std::string read_token(const LinkOptions& options, protocol::Role role) try {
  return protocol::read_token_file(options.token_file, role);
} catch (const std::runtime_error& error) {
  throw ExitError(kUsage, error.what());
}

std::pair<std::string, std::uint16_t> server_of(const LinkOptions& options) try {
  return protocol::parse_address(options.connect);
} catch (const std::invalid_argument& error) {
  throw ExitError(kUsage, std::string("--connect: ") + error.what());
}

protocol::Connection open_link(const LinkOptions& options, protocol::Role role,
                               const std::string& client_name) {
  const protocol::Hello hello{protocol::kProtocolVersion, protocol::kProtocolVersion, client_name, role,
                              read_token(options, role)};
  const auto [host, port] = server_of(options);
  return protocol::Connection(host, port, hello, std::chrono::seconds(5), options.tls);
}

protocol::PartDescriptionReply describe_part(protocol::Connection& link, const std::string& part) {
  std::vector<std::string> names;
  for (const auto& summary : link.request_as<protocol::PartList>(protocol::ListParts{}).parts) {
    names.push_back(summary.name);
  }
  if (std::find(names.begin(), names.end(), part) == names.end()) {
    throw ExitError(kUsage, config::unknown_name("part", part, names));
  }
  return link.request_as<protocol::PartDescriptionReply>(protocol::DescribePart{part});
}

}  // namespace visum::cli

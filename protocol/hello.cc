#include "protocol/hello.h"

#include <algorithm>

#include "protocol/config/printable.h"
#include "protocol/limits.h"

namespace visum::protocol {
namespace {

constexpr std::uint32_t kOldestVersion = 1;

std::string range(std::uint32_t from, std::uint32_t to) {
  return from == to ? std::to_string(from) : std::to_string(from) + " to " + std::to_string(to);
}

}  // namespace

std::optional<Error> refuse_hello(const Hello& hello, std::uint32_t& version) {
  if (hello.min_version > hello.max_version)
    return Error{ErrorCode::kVersion, "the hello's min_version is above its max_version", {}};
  version = std::min(hello.max_version, kProtocolVersion);
  if (version < std::max(hello.min_version, kOldestVersion))
    return Error{ErrorCode::kVersion,
                 "this server speaks protocol version " + range(kOldestVersion, kProtocolVersion) +
                     ", the client " + range(hello.min_version, hello.max_version),
                 {}};
  if (hello.role == Role::kUnspecified)
    return Error{ErrorCode::kBadValue, "the hello names no role (observer, controller or admin)", {}};
  if (hello.client_name.size() > kMaxClientName)
    return Error{
        ErrorCode::kBadValue, "client_name has more than " + std::to_string(kMaxClientName) + " bytes", {}};
  if (!config::is_printable(hello.client_name))
    return Error{ErrorCode::kBadValue, std::string("client_name ") + config::kNotPrintable, {}};
  return std::nullopt;
}

}  // namespace visum::protocol

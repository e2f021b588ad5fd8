#include "clients/cpp/visum.h"

#include "clients/cpp/client_state.h"

namespace visum {

Error::Error(ErrorCode code, const std::string& text, std::string part, std::string port, std::string owner)
    : std::runtime_error(text),
      code_(code),
      part_(std::move(part)),
      port_(std::move(port)),
      owner_(std::move(owner)) {}

const char* to_string(ErrorCode code) {
  if (code == ErrorCode::kConnection) return "connection";
  if (code == ErrorCode::kMisuse) return "misuse";
  return protocol::to_string(static_cast<protocol::ErrorCode>(code));
}

namespace detail {

Error to_error(const protocol::RequestError& refusal, const std::string& part, const std::string& port) {
  return Error(static_cast<ErrorCode>(refusal.code()), refusal.what(), part, port, refusal.owner());
}

Error to_error(const protocol::Error& refusal, const std::string& part, const std::string& port) {
  return Error(static_cast<ErrorCode>(refusal.code), refusal.text, part, port, refusal.owner);
}

}  // namespace detail
}  // namespace visum

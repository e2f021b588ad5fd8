#include "server/gateway/session_gate.h"

namespace visum::gateway {
namespace {

using namespace protocol;

std::string key_of(const Read& request) {
  return "read " + request.part;
}
std::string key_of(const ReadWorld&) {
  return "read world";
}
std::string key_of(const ReadBlackboard& request) {
  return "blackboard " + std::to_string(request.offset) + " " + request.part + "/" + request.name;
}
std::string key_of(const Write& request) {
  return "write " + std::to_string(request.first_port) + " " + request.part;
}
template <typename Other>
std::string key_of(const Other&) {
  return {};
}

}  // namespace

bool SessionGate::ends_cycle(const Request& request) {
  const auto key = std::visit([](const auto& message) { return key_of(message); }, request);
  if (key.empty() || asked_.insert(key).second) return false;
  asked_ = {key};
  return true;
}

}  // namespace visum::gateway

#include "server/gateway/access.h"

#include <algorithm>
#include <sstream>
#include <type_traits>

#include "protocol/config/config.h"
#include "protocol/config/secret_file.h"

namespace visum::gateway {
namespace {

using protocol::Role;

template <typename T, typename... Of>
inline constexpr bool kIsOneOf = (std::is_same_v<T, Of> || ...);

// Takes the same time wherever the first difference is, so that a token cannot be guessed byte by byte.
bool equal_in_constant_time(const std::string& a, const std::string& b) {
  unsigned char difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference = static_cast<unsigned char>(difference | (a[i] ^ (b.empty() ? 0 : b[i % b.size()])));
  return difference == 0;
}

constexpr std::string_view kName = "CN=";

// The rest of a line, without blanks around it.
std::string rest_of(std::istringstream& words) {
  std::string rest;
  std::getline(words >> std::ws, rest);
  return rest.substr(0, rest.find_last_not_of(" \t\r") + 1);
}

Role role_named(const std::string& word) {
  if (word == "observer") return Role::kObserver;
  if (word == "controller") return Role::kController;
  if (word == "admin") return Role::kAdmin;
  return Role::kUnspecified;
}

}  // namespace

bool is_emergency_stop(const protocol::Request& request) {
  const auto* set = std::get_if<protocol::SetParameter>(&request);
  const bool* on = set ? std::get_if<bool>(&set->value) : nullptr;
  return on && *on && set->name == protocol::kEmergencyStop;
}

Role role_needed(const protocol::Request& request) {
  if (is_emergency_stop(request)) return Role::kObserver;
  return std::visit(
      [](const auto& message) {
        using namespace protocol;
        using T = std::decay_t<decltype(message)>;
        if constexpr (kIsOneOf<T, Status, ListParts, DescribePart, Read, Subscribe, Unsubscribe,
                               GetParameters, ReadBlackboard, DescribeWorld, ReadWorld, SubscribeWorld,
                               UnsubscribeWorld, ReadMesh, ReadTexture, ListFaults, SubscribeEvents,
                               UnsubscribeEvents, ListModels, ListModules, ListScenes, ReadScenario>)
          return Role::kObserver;
        else if constexpr (kIsOneOf<T, AcquireLease, ReleaseLease, Write, SetParameter, WriteBlackboard, Join,
                                    Advance, Leave, Note, Announce, AnnounceModules, ReportModules,
                                    OverrideModulePort, SetModuleParameter, LockBlackboard, UnlockBlackboard>)
          return Role::kController;
        else
          return Role::kAdmin;
      },
      request);
}

bool needs_world(const protocol::Request& request) {
  return std::visit(
      [](const auto& message) {
        using namespace protocol;
        using T = std::decay_t<decltype(message)>;
        return kIsOneOf<T, Pause, Resume, Step, SetSpeed, Reset, TakeSnapshot, RestoreSnapshot, PushBody,
                        AddBody, RemoveBody, InjectFault, ClearFault, SetBody, SetJoints, PullBody,
                        ReleaseBody, StartRecording, StopRecording, SpawnModel, RemoveModel, ListModels,
                        ListScenes, LoadScene>;
      },
      request);
}

bool leaves_recording(const protocol::Request& request, const std::string& steering) {
  using namespace protocol;
  if (const auto* set = std::get_if<SetParameter>(&request)) return set->part == steering;
  return role_needed(request) == Role::kObserver ||
         std::visit(
             [](const auto& message) {
               return kIsOneOf<std::decay_t<decltype(message)>, Pause, Resume, Step, SetSpeed, Shutdown>;
             },
             request);
}

Tokens::Entry Tokens::read_entry(Role role, const std::string& words, const config::Place& place) {
  if (words.starts_with(kName)) {
    if (words.size() == kName.size()) throw config::ConfigError(place, "CN= without a name");
    return {role, {}, words.substr(kName.size())};
  }
  if (words.find_first_of(" \t") != std::string::npos)
    throw config::ConfigError(place, "more than a role and a token");
  if (words.size() < 16) throw config::ConfigError(place, "the token has less than 16 characters");
  return {role, words, {}};
}

Tokens::Tokens(const std::filesystem::path& file) {
  std::istringstream in(config::read_secret_file(file));
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    std::istringstream words(line.substr(0, line.find('#')));
    std::string role;
    if (!(words >> role)) continue;
    const config::Place place{file.string(), number, ""};
    if (role_named(role) == Role::kUnspecified)
      throw config::ConfigError(place, "'" + role + "' is no role: observer, controller or admin");
    entries_.push_back(read_entry(role_named(role), rest_of(words), place));
  }
  if (entries_.empty()) throw config::ConfigError({file.string(), 0, ""}, "holds no token");
}

Role Tokens::grant(const std::string& token, const std::string& identity, Role wanted) const {
  if (!required()) return wanted;
  Role best = Role::kUnspecified;
  for (const auto& entry : entries_) {
    const bool is_his = entry.token.empty() ? entry.identity == identity  // a name is no secret
                                            : equal_in_constant_time(entry.token, token);
    if (is_his) best = std::max(best, entry.role);
  }
  return std::min(best, wanted);
}

bool is_loopback(const std::string& address) {
  return address == "localhost" || address == "::1" || address.starts_with("127.");
}

}  // namespace visum::gateway

// The modules that clients have announced, by part. The server keeps one to relay them; a controller's part
// keeps one for the parts above it. Pure data on the thread of the sessions.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/messages.h"

namespace visum::protocol {

class ModuleBoard {
 public:
  // A refusal has a code and a text.
  using Refusal = std::optional<std::pair<ErrorCode, std::string>>;

  static constexpr std::size_t kMostParts = 64;
  static constexpr std::size_t kMostModules = 1024;     // of a part
  static constexpr std::size_t kMostEdges = 4096;       // of a part
  static constexpr std::size_t kMostPorts = 16384;      // of a part
  static constexpr std::size_t kMostParameters = 4096;  // of a part
  static constexpr std::size_t kMostBlackboards = 64;   // of a part
  static constexpr std::size_t kMostNameBytes = 256;    // of a unit and a choice, too
  static constexpr std::size_t kMostTextBytes = 1024;   // of a parameter's value, and of its help
  static constexpr std::size_t kMostHeadBytes = 1024;   // of a blackboard

  // Returns why this cannot be announced.
  static std::optional<std::string> check(const AnnounceModules& announced);

  // Takes what a session announces, in place of what it has announced of that part before.
  Refusal announce(std::uint64_t session, const std::string& client, const AnnounceModules& announced);
  Refusal report(std::uint64_t session, const ReportModules& reported);
  // The session has ended. Returns the names of its parts.
  std::vector<std::string> forget(std::uint64_t session);

  // kUnknownName if `request` names a part that nobody has announced.
  Refusal check(const ListModules& request) const;
  ModuleList list(const ListModules& request) const;

  // Finds the session that an order goes to. Otherwise `refusal` says why not.
  std::optional<std::uint64_t> target_of(const OverrideModulePort& request, Refusal& refusal) const;
  std::optional<std::uint64_t> target_of(const SetModuleParameter& request, Refusal& refusal) const;

 private:
  struct Entry {
    std::uint64_t session = 0;
    ModulePart part;
  };
  const Entry* find(const std::string& part, Refusal& refusal) const;

  std::map<std::string, Entry> parts_;  // by name
  std::uint64_t revision_ = 1;
};

}  // namespace visum::protocol

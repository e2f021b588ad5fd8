#include "clients/visum/exec/bus_of.h"

#include <algorithm>
#include <set>

#include "clients/visum/common/exit_code.h"

namespace visum::exec {
namespace {

using protocol::PartBus;

bool is_of(const PartBus& bus, const std::string& part, const std::string& kind) {
  return bus.name.starts_with(kind + ":") && (part.empty() || bus.part == part);
}

[[noreturn]] void fail(const std::vector<PartBus>& buses, const std::string& part, const std::string& kind,
                       Advice advice) {
  std::string there;
  for (const auto& bus : buses) there += (there.empty() ? "" : ", ") + bus.part + "=" + bus.name;
  const auto who = part.empty() ? "no part has a " : "part '" + part + "' has no ";
  const auto name = part.empty() ? "PART" : part;
  const auto what = advice == Advice::kOwnOptions
                        ? "add --bus " + name + "=" + kind
                        : "start visumd with --bus " + name + "=" + kind + (kind == "tcp" ? ":0" : ":PATH");
  throw cli::ExitError(cli::kUsage,
                       who + kind + " bus; " + what + " (" +
                           (there.empty() ? "the server has no bus" : "the server has " + there) + ")");
}

}  // namespace

std::string bus_of(const std::vector<PartBus>& buses, const std::string& part, const std::string& kind,
                   Advice advice) {
  const auto wanted = [&](const PartBus& bus) { return is_of(bus, part, kind); };
  const auto found = std::ranges::find_if(buses, wanted);
  if (found == buses.end()) fail(buses, part, kind, advice);
  std::set<std::string> parts;
  for (const auto& bus : buses)
    if (wanted(bus)) parts.insert(bus.part);
  if (parts.size() > 1)
    throw cli::ExitError(cli::kUsage, "several parts have a " + kind + " bus; name one of them: " +
                                          *parts.begin() + ", " + *parts.rbegin());
  return found->name.substr(kind.size() + 1);
}

}  // namespace visum::exec

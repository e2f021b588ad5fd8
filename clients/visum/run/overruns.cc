#include "clients/visum/run/overruns.h"

#include <algorithm>

#include "clients/visum/common/format.h"

namespace visum::run {

std::string why_invalid(const protocol::ServerStatus& before, const protocol::ServerStatus& after,
                        double most_overruns) {
  if (after.clock != "realtime") return {};
  const auto begin = before.era == after.era ? before.tick : 0;
  const auto ticks = std::max<std::int64_t>(1, after.tick - begin);
  // The tick that is under way is counted already.
  const auto late = std::min(static_cast<std::int64_t>(after.overruns - before.overruns), ticks);
  if (static_cast<double>(late) <= most_overruns * static_cast<double>(ticks)) return {};
  return "this host is too slow for " + cli::rounded(after.speed, 4) +
         " x real time: " + std::to_string(late) + " of " + std::to_string(ticks) +
         " ticks began more than a tick late (at most " + cli::rounded(100.0 * most_overruns, 3) +
         " % may), the worst by " + cli::fixed(static_cast<double>(after.lateness_max_ns) * 1e-6, 3) + " ms";
}

}  // namespace visum::run

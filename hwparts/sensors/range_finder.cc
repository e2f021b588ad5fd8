#include "hwparts/sensors/range_finder.h"

namespace visum::sensors {

Reach read_reach(const config::Node& entry) {
  constexpr double kFarthest_m = 1e5;
  const config::Node range = entry.get("range");
  const auto ends = range.numbers(2, {0.0, kFarthest_m});
  if (ends[0] >= ends[1]) range.fail("must be [lowest, highest], the lowest first");
  return {ends[0], ends[1]};
}

std::vector<double> read_beams(const config::Node& entry) {
  constexpr double kTurn = 6.2831853071795865;
  const std::int64_t count = entry.get("rays").integer(2, kMaxRays);
  const config::Node angle = entry.get("angle");
  const auto ends = angle.numbers(2, {-kTurn, kTurn});
  if (ends[0] >= ends[1]) angle.fail("must be [first, last], the smaller first");
  std::vector<double> beams;
  const double last = static_cast<double>(count - 1);
  for (std::int64_t i = 0; i < count; ++i)
    beams.push_back(ends[0] + (ends[1] - ends[0]) * (static_cast<double>(i) / last));
  return beams;
}

}  // namespace visum::sensors

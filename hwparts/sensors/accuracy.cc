#include "hwparts/sensors/accuracy.h"

#include <algorithm>
#include <cmath>

namespace visum::sensors {

Accuracy read_accuracy(const config::Node& map, double lowest, double highest) {
  const config::Range span{0.0, highest - lowest};
  Accuracy accuracy{lowest, highest};
  accuracy.noise = map.number_or("noise", 0.0, span);
  accuracy.noise_share = map.number_or("noise_share", 0.0, {0.0, 1.0});
  accuracy.bias = map.number_or("bias", 0.0, span);
  accuracy.resolution = map.number_or("resolution", 0.0, span);
  return accuracy;
}

Accuracy read_symmetric(const config::Node& parent, std::string_view key, double widest) {
  const auto map = parent.find(key);
  if (!map) return {-widest, widest};
  map->allow_only({"range", "noise", "noise_share", "bias", "resolution"});
  const double range = map->number_or("range", widest, {0.0, widest, true});
  return read_accuracy(*map, -range, range);
}

double disturbed(const Accuracy& accuracy, double truth, double offset, Random& random) {
  if (!std::isfinite(truth)) return truth;
  const double deviation = accuracy.noise + accuracy.noise_share * std::abs(truth);
  return truth + offset + (deviation > 0.0 ? deviation * random.normal() : 0.0);
}

double quantised(const Accuracy& accuracy, double value) {
  if (accuracy.resolution > 0.0) value = std::round(value / accuracy.resolution) * accuracy.resolution;
  return std::clamp(value, accuracy.lowest, accuracy.highest);
}

}  // namespace visum::sensors

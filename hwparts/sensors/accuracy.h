// What a sensor does to one true number: a constant offset, noise, steps, and the ends of its range.
#pragma once

#include "hwparts/sensors/random.h"
#include "protocol/config/config.h"

namespace visum::sensors {

// All in the unit of what is measured, but for `noise_share`.
struct Accuracy {
  double lowest = 0.0, highest = 0.0;  // nothing beyond is ever read
  double noise = 0.0;                  // standard deviation of each reading
  double noise_share = 0.0;            // the same, as a share of the true value
  double bias = 0.0;                   // standard deviation of the offset that is drawn at start
  double resolution = 0.0;             // size of a step; 0: as fine as numbers are
};

// `noise`, `noise_share`, `bias` and `resolution` of a map; the range is the caller's.
Accuracy read_accuracy(const config::Node& map, double lowest, double highest);
// The same of the map `key` in `parent`, and `range` in it: as far both ways. `widest` where there is none.
Accuracy read_symmetric(const config::Node& parent, std::string_view key, double widest);

// One reading without a fault, not yet in steps: the true value with this offset and fresh noise. What is
// infinite stays so.
double disturbed(const Accuracy& accuracy, double truth, double offset, Random& random);
// In steps, and within the range.
double quantised(const Accuracy& accuracy, double value);

}  // namespace visum::sensors

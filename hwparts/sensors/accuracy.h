// The errors that a sensor adds to one true number: a constant offset, noise, steps, and the ends of its
// range. Pure functions.
#pragma once

#include "hwparts/sensors/random.h"
#include "protocol/config/config.h"

namespace visum::sensors {

// All in the unit of the measured quantity, except `noise_share`.
struct Accuracy {
  double lowest = 0.0, highest = 0.0;  // no reading lies beyond
  double noise = 0.0;                  // standard deviation of each reading
  double noise_share = 0.0;            // the same, as a share of the true value
  double bias = 0.0;                   // standard deviation of the offset that is drawn at start
  double resolution = 0.0;             // size of a step; 0: no steps
};

// Reads `noise`, `noise_share`, `bias` and `resolution` from a map. The caller gives the range.
Accuracy read_accuracy(const config::Node& map, double lowest, double highest);
// Reads the same from the map `key` in `parent`, and its `range`, which reaches as far both ways. Without
// one, the range is `widest`.
Accuracy read_symmetric(const config::Node& parent, std::string_view key, double widest);

// One reading without a fault, before steps: the true value with this offset and fresh noise. An infinite
// value stays infinite.
double disturbed(const Accuracy& accuracy, double truth, double offset, Random& random);
// `value` rounded to steps, within the range.
double quantised(const Accuracy& accuracy, double value);

}  // namespace visum::sensors

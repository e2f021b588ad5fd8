// Sensors for distances: the kind `distance` with one ray, the kind `scanner` with many. A ray goes along +x
// of the sensor's frame; a scanner's rays turn about its z axis.
#pragma once

#include <memory>
#include <vector>

#include "hwparts/sensors/sensor.h"

namespace visum::sensors {

// `range: [lowest, highest]` of an entry, m. A distance outside of it reads as the nearer end.
struct Reach {
  double lowest_m, highest_m;
};
Reach read_reach(const config::Node& entry);

// The angles of a scanner's rays: `rays` and `angle: [first, last]`, rad, from x towards y.
std::vector<double> read_beams(const config::Node& entry);
inline constexpr std::int64_t kMaxRays = 4096;

// The truth of both kinds: one distance per ray, m; infinite where the ray meets nothing in reach.
std::unique_ptr<Sensor> make_distance(const SensorContext& context);
std::unique_ptr<Sensor> make_scanner(const SensorContext& context);

}  // namespace visum::sensors

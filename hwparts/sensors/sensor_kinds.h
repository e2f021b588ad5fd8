// The table of the kinds of sensor, by name: one line each in sensor_kinds.cc. server/sensing has a table of
// the same names, with the probes that measure the truth in the world.
#pragma once

#include "hwparts/sensors/sensor.h"

namespace visum::sensors {

struct SensorKind {
  const char* name;
  const char* help;
  std::unique_ptr<Sensor> (*make)(const SensorContext&);
};
std::span<const SensorKind> sensor_kinds();
// Throws ConfigError at the entry's `kind` where the table has no such kind, and for every error in the
// entry.
std::unique_ptr<Sensor> make_sensor(const std::string& kind, const SensorContext& context);

}  // namespace visum::sensors

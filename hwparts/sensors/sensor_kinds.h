// The kinds of sensor, by name: one line each in sensor_kinds.cc. What a kind is told of the world stands in
// the table of the same names in server/sensing.
#pragma once

#include "hwparts/sensors/sensor.h"

namespace visum::sensors {

struct SensorKind {
  const char* name;
  const char* help;
  std::unique_ptr<Sensor> (*make)(const SensorContext&);
};
std::span<const SensorKind> sensor_kinds();
// Throws ConfigError: at the entry's `kind` where there is no such kind, and at what is wrong in the entry.
std::unique_ptr<Sensor> make_sensor(const std::string& kind, const SensorContext& context);

}  // namespace visum::sensors

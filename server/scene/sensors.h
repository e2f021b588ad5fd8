// Reads the entries of `sensors:`: where a sensor sits. The kind of the sensor reads the rest of its entry.
#pragma once

#include "server/scene/draft.h"

namespace visum::scene {

// Reads one entry. find_measured_joints() finds the joint that it measures, later.
void read_sensor(Draft& draft, const config::Node& entry);

// Call it after sort_world(), when the ids of joints are final.
void find_measured_joints(Draft& draft);

inline constexpr std::size_t kMaxSensors = 256;

}  // namespace visum::scene

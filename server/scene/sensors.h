// The entries of `sensors:`: where a sensor sits. What else stands in an entry is read by the sensor's kind.
#pragma once

#include "server/scene/draft.h"

namespace visum::scene {

// One entry. Which joint it measures is left to find_measured_joints().
void read_sensor(Draft& draft, const config::Node& entry);

// After sort_world: joint ids are final.
void find_measured_joints(Draft& draft);

inline constexpr std::size_t kMaxSensors = 256;

}  // namespace visum::scene

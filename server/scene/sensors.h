// The entries of `sensors:`: where a sensor sits. What else stands in an entry is read by the sensor's kind.
#pragma once

#include "server/scene/draft.h"

namespace visum::scene {

// After sort_world: joint ids are final.
void plan_sensors(Draft& draft);

inline constexpr std::size_t kMaxSensors = 256;

}  // namespace visum::scene

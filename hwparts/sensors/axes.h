// Adds ports and numbers that come in threes, one for each axis.
#pragma once

#include <string>

#include "hwparts/sensors/sensor.h"

namespace visum::sensors {

// "Force X", "Force Y", "Force Z", each with this accuracy.
inline void add_axes(Layout& layout, const std::string& quantity, const char* unit,
                     const Accuracy& accuracy) {
  for (const char* axis : {" X", " Y", " Z"}) {
    layout.ports.push_back({quantity + axis, unit, accuracy.lowest, accuracy.highest, 0.0, quantity});
    layout.numbers.push_back(accuracy);
  }
}

}  // namespace visum::sensors

// The encoder sits on the motor's shaft. Torsion and backlash of the gear lie behind it, so it does not see
// them. Pure functions.
#pragma once

#include "hwparts/drive/drive_data.h"

namespace visum::drive {

// `position` rounded to whole increments, in [u].
double quantised(const DriveData& data, double position);

// The measured speed: the difference of two readings through a first-order low pass.
double filtered_speed(const LoopData& loop, double speed, double difference, double tick_s);

}  // namespace visum::drive

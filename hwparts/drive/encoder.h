// The encoder sits on the motor's shaft: torsion and backlash of the gear are behind it, and it does not see
// them.
#pragma once

#include "hwparts/drive/drive_data.h"

namespace visum::drive {

// The whole number of increments next to `position`, in [u].
double quantised(const DriveData& data, double position);

// The measured speed: the difference of two readings through a first-order low pass.
double filtered_speed(const LoopData& loop, double speed, double difference, double tick_s);

}  // namespace visum::drive

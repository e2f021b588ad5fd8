// The cascade: P position around PI velocity, with the setpoint's speed fed forward, anti-windup, and a
// current command that is limited by what can flow. Reads only what the encoder says.
#pragma once

#include "hwparts/drive/drive_data.h"
#include "hwparts/drive/drive_state.h"
#include "hwparts/drive/motor.h"

namespace visum::drive {

struct CurrentCommand {
  double current = 0.0;     // A, inside the window
  double integral = 0.0;    // A, the new integral part
  bool limited = false;     // more was wanted
  bool by_voltage = false;  // ... and it was the supply that limited
};

// A current that is commanded, as far as it can flow. The integral part stays.
CurrentCommand limit_current(double wanted, double integral, const CurrentWindow& window);

CurrentCommand control_current(const DriveData& data, const DriveState& state, const CurrentWindow& window,
                               double tick_s);

}  // namespace visum::drive

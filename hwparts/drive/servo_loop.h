// The servo's cascade: a P position loop around a PI velocity loop, with the setpoint's speed fed forward and
// anti-windup. The current command is limited to what can flow. It reads only what the encoder says. Pure
// functions.
#pragma once

#include "hwparts/drive/drive_data.h"
#include "hwparts/drive/drive_state.h"
#include "hwparts/drive/motor.h"

namespace visum::drive {

struct CurrentCommand {
  double wanted = 0.0;      // A
  double current = 0.0;     // A, as much of that as is inside the window
  double integral = 0.0;    // A, the new integral part
  bool limited = false;     // more was wanted
  bool by_voltage = false;  // it was the supply's voltage that limited it
};

// The commanded current, as far as it can flow. The integral part stays.
CurrentCommand limit_current(double wanted, double integral, const CurrentWindow& window);

// One run of the cascade, which runs every `period_s`.
CurrentCommand control_current(const DriveData& data, const DriveState& state, const CurrentWindow& window,
                               double period_s);

}  // namespace visum::drive

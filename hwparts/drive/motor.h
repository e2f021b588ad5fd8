// The DC motor: what current it can take, what effort that gives, and what the current does to the winding.
// The current follows its command at once: the electrical time constant is shorter than a tick.
#pragma once

#include "hwparts/drive/drive_data.h"

namespace visum::drive {

// The currents that can flow [A]: within the limit, and with the voltage that the back-EMF leaves.
struct CurrentWindow {
  double lower;
  double upper;
  bool lower_by_voltage;
  bool upper_by_voltage;
};
CurrentWindow current_window(const DriveData& data, double supply_voltage, double speed);

// I²t: what has flowed above the nominal current [A²s]; sinks below it, never under 0.
double advance_i2t(const MotorData& motor, double i2t, double current, double tick_s);
double i2t_budget(const MotorData& motor);

// First-order winding temperature [°C].
double advance_winding(const MotorData& motor, double winding, double current, double tick_s);

}  // namespace visum::drive

// The DC motor: the currents that can flow, and how a current heats the winding. The current follows its
// command at once, since the electrical time constant is shorter than a tick. Pure functions.
#pragma once

#include "hwparts/drive/drive_data.h"

namespace visum::drive {

// The currents that can flow [A]: within the motor's limit, and with the voltage that the back-EMF leaves.
// The flags say where the voltage is the tighter bound.
struct CurrentWindow {
  double lower;
  double upper;
  bool lower_by_voltage;
  bool upper_by_voltage;
};
CurrentWindow current_window(const DriveData& data, double supply_voltage, double speed);

// I²t [A²s] after one more tick: it grows while the current is above the nominal one, sinks below it, and
// never falls under 0.
double advance_i2t(const MotorData& motor, double i2t, double current, double tick_s);
// The I²t at which the motor is switched off [A²s].
double i2t_budget(const MotorData& motor);
// The time [s] without current until a motor that was switched off may be switched on again: half of its
// budget must be free.
double i2t_rest(const MotorData& motor, double i2t);

// First-order winding temperature [°C].
double advance_winding(const MotorData& motor, double winding, double current, double tick_s);

}  // namespace visum::drive

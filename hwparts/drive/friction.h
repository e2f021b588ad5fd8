// Friction of motor and gear, seen at the output: viscous plus a Coulomb part that is the coefficient of a
// tanh, as it was identified on the real arm (Georgia Tech, Krang).
#pragma once

#include "hwparts/drive/drive_data.h"

namespace visum::drive {

// [F] against a motion with `speed` [u]/s. Odd.
double friction_effort(const GearData& gear, double speed);

// friction_effort / speed, and its limit at standstill: [F]/([u]/s). Friction taken as secant * (speed at the
// tick's end) can slow a motion down but never turn it around, at any step length.
double friction_secant(const GearData& gear, double speed);

}  // namespace visum::drive

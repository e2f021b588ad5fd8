// Friction of motor and gear, seen at the output: viscous friction plus a Coulomb part, which is the
// coefficient of a tanh. It was identified in this form on the real arm (Georgia Tech, Krang). Pure
// functions.
#pragma once

#include "hwparts/drive/drive_data.h"

namespace visum::drive {

// The effort [F] against a motion with `speed` [u]/s. An odd function.
double friction_effort(const GearData& gear, double speed);

// friction_effort / speed, or its limit at standstill: [F]/([u]/s). Friction taken as secant * (speed at the
// tick's end) can slow a motion down but never turn it around, at any step length.
double friction_secant(const GearData& gear, double speed);

}  // namespace visum::drive

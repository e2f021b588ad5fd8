// The catalogue of servo classes: motors of public data sheets, for drives files that name a class (`servo:
// 250W`) and leave out what they do not know. DRIVES.md names the sources. Constant data and pure functions.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "hwparts/drive/drive_data.h"

namespace visum::drive {

// Figures of the data sheet, in its words; all at nominal voltage and 25 °C.
struct ServoClass {
  const char* name;             // "250W"
  const char* motor;            // "maxon RE 65, 353297"
  double nominal_voltage;       // V
  double no_load_speed;         // rad/s
  double no_load_current;       // A
  double nominal_torque;        // N·m, can be given forever
  double nominal_current;       // A
  double resistance;            // ohm
  double torque_constant;       // N·m/A
  double rotor_inertia;         // kg·m²
  double thermal_resistance;    // K/W, winding to housing and housing to surroundings together
  double thermal_time_winding;  // s
  double maximum_winding;       // °C
};
std::span<const ServoClass> servo_classes();
std::vector<std::string> servo_class_names();
// The class of that name; null: there is none.
const ServoClass* find_servo_class(const std::string& name);

// The motor behind a gear of `ratio` [motor rad per u]: N·m or N.
double nominal_effort(const ServoClass& servo, double ratio);
double peak_effort(const ServoClass& servo, double ratio);
// The fastest [u]/s that the motor drives at its nominal voltage, with room for a load.
double usable_speed(const ServoClass& servo, double ratio);
// The ratio with which that is `speed`.
double ratio_for_speed(const ServoClass& servo, double speed);

// Everything that a drives file may leave out, for this class, ratio and joint. Only the motor's figures have
// a source; the rest are choices of ours, which DRIVES.md gives with their reasons.
DriveData class_defaults(const ServoClass& servo, double ratio, bool linear, const JointBounds& joint);
// The ratio that class_defaults() suits best.
double default_ratio(const ServoClass& servo, bool linear, const JointBounds& joint);

}  // namespace visum::drive

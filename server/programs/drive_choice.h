// Chooses a servo class, a gear ratio and gains for a joint by what hangs behind it. Pure functions.
#pragma once

#include <string>
#include <vector>

#include "hwparts/drive/servo_classes.h"
#include "hwparts/part.h"
#include "server/programs/joint_loads.h"

namespace visum::programs {

// Units as in drive_data.h: [u] is rad or m, [F] is N·m or N.
struct DriveChoice {
  const drive::ServoClass* servo = nullptr;
  double ratio = 0.0;                // motor rad per [u]
  double speed = 0.0;                // [u]/s
  double acceleration = 0.0;         // [u]/s²
  double current_limit = 0.0;        // A
  double following_error = 0.0;      // [u]
  double position_gain = 0.0;        // 1/s
  double velocity_bandwidth = 0.0;   // 1/s, around the bare rotor
  double integral_time = 0.0;        // s
  double kp = 0.0;                   // [F]/[u]: the loop's stiffness at the joint
  double kd = 0.0;                   // [F]/([u]/s): its damping
  double rotor_inertia = 0.0;        // kg·m² or kg, behind the gear
  std::vector<std::string> missing;  // one sentence each: what the model did not say, or no class can do
};

// The smallest class that turns the joint at the model's speed, holds 1.3 times the gravity for ever, and
// accelerates to that speed in 0.5 s. If none does, the strongest class with a slower gear.
DriveChoice choose_drive(const hwparts::JointInfo& joint, const JointLoad& load);

}  // namespace visum::programs

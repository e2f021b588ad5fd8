// The two plain values through which a drive meets mechanics. The world fills the sample and applies the
// drive; so does a test. Revolute: rad, rad/s, N·m. Prismatic: m, m/s, N. Constant size, no ownership.
#pragma once

namespace visum::hwparts {

// The joint at the end of the last tick.
struct JointSample {
  double position = 0.0;  // unwrapped: a joint that turns twice reads 4 pi
  double velocity = 0.0;
  double effort = 0.0;  // transmitted by the drive to the joint during the last tick (see JointDrive)
};

// The effort on the joint during the next tick. The engine transmits
//     effort = clamp((target_velocity - v) / compliance, -max_effort, +max_effort) + feedforward
// with v the joint's velocity at the END of the tick, i.e. implicitly. This one row expresses, stably at any
// stiffness: a gear spring and rotor in series, a pure torque (max_effort = 0), an ideal velocity servo
// (compliance = 0), and dry friction (target_velocity = 0, compliance = 0, max_effort = the friction).
struct JointDrive {
  double target_velocity = 0.0;
  double compliance = 0.0;  // (rad/s)/(N·m) or (m/s)/N; >= 0
  double max_effort = 0.0;  // >= 0; 0 switches the first term off
  double feedforward = 0.0;
};

}  // namespace visum::hwparts

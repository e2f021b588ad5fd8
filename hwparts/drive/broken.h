// What is broken about a drive on purpose, for as long as it is (hwparts/fault_kinds.h). Plain; it follows
// from the faults that act, so that it is no state of the drive. Units as in drive_data.h.
#pragma once

#include <limits>

namespace visum::drive {

enum class BrakeFault { kNone, kStuckClosed, kStuckOpen };

struct Broken {
  bool encoder_stuck = false;
  double encoder_offset = 0.0;     // [u]
  double encoder_deviation = 0.0;  // [u], of its noise
  double torque_share = 1.0;       // of the motor's effort: what is left
  BrakeFault brake = BrakeFault::kNone;
  double slip_effort = std::numeric_limits<double>::infinity();     // [F], more the gear does not carry
  double least_winding = -std::numeric_limits<double>::infinity();  // °C
};

}  // namespace visum::drive

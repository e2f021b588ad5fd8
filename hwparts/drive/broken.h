// The faults on purpose (hwparts/fault_kinds.h) that act on one drive now. A plain value. It is not part of
// the drive's state, since it follows from the list of faults that act. Units as in drive_data.h.
#pragma once

#include <limits>

namespace visum::drive {

enum class BrakeFault { kNone, kStuckClosed, kStuckOpen };

struct Broken {
  bool encoder_stuck = false;
  double encoder_offset = 0.0;     // [u]
  double encoder_deviation = 0.0;  // [u], of its noise
  double torque_share = 1.0;       // share of the motor's effort that is left
  BrakeFault brake = BrakeFault::kNone;
  double slip_effort = std::numeric_limits<double>::infinity();     // [F], the gear carries no more
  double least_winding = -std::numeric_limits<double>::infinity();  // °C
};

}  // namespace visum::drive

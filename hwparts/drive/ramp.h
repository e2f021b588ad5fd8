// The ramp generator: an online trapezoid. Every tick it plans the fastest way to the target anew, from the
// setpoint's present position and speed, within maximum speed and acceleration. It then goes one tick along
// that way. So target, speed and acceleration may change at any tick without a jump. The way stays
// time-optimal, since the rest of a fastest way is a fastest way.
//
// The setpoint never passes the target, unless the target was put nearer than the braking distance: then it
// brakes and comes back. It reaches a maximum speed below the present one on a ramp. It arrives exactly:
// position == target, speed == 0. Pure functions.
#pragma once

#include <cstdint>

namespace visum::drive {

enum class RampPhase : std::uint8_t { kEnd, kAccelerating, kSteady, kDecelerating };

struct Setpoint {
  double position = 0.0;
  double speed = 0.0;
  RampPhase phase = RampPhase::kEnd;
};

// The phase of a tick in which the speed changes from `before` to `after`.
RampPhase phase_of(double before, double after);

// One tick towards `target`. Needs maximum_speed >= 0 (0: stops where it can, and stands), acceleration > 0
// and tick_s > 0.
Setpoint ramp_to(const Setpoint& from, double target, double maximum_speed, double acceleration,
                 double tick_s);

// One tick of stopping as fast as `deceleration` allows.
Setpoint ramp_stop(const Setpoint& from, double deceleration, double tick_s);

}  // namespace visum::drive

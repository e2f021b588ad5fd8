// The ramp generator: an online trapezoid. Every tick it plans anew the fastest way from where the setpoint
// is and how fast it moves to the target, within maximum speed and acceleration, and goes one tick along it.
// So the target, the speed and the acceleration may change at any tick without a jump; the way is the
// time-optimal one, since the rest of a fastest way is a fastest way.
//
// Never beyond the target, unless it was put nearer than the braking distance: then it brakes and comes back.
// A maximum speed below the present one is reached on a ramp. Arrives exactly: position == target, speed ==
// 0.
#pragma once

#include <cstdint>

namespace visum::drive {

enum class RampPhase : std::uint8_t { kEnd, kAccelerating, kSteady, kDecelerating };

struct Setpoint {
  double position = 0.0;
  double speed = 0.0;
  RampPhase phase = RampPhase::kEnd;
};

// Of a tick in which the speed becomes `after`.
RampPhase phase_of(double before, double after);

// One tick towards `target`. maximum_speed >= 0 (0: stops where it can, and stands), acceleration > 0, tick_s
// > 0.
Setpoint ramp_to(const Setpoint& from, double target, double maximum_speed, double acceleration,
                 double tick_s);

// One tick of stopping as fast as `deceleration` allows.
Setpoint ramp_stop(const Setpoint& from, double deceleration, double tick_s);

}  // namespace visum::drive

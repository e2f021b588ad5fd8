// The motions that a field bus can command: ramps, steps with a queue of one, constant velocity, and current.
// While one is in force, the drive ignores the ports' desired value until that becomes another one.
//
// A step means "be at p in t". A step by itself is a trapezoid. It arrives at rest when it is due, or as soon
// as the limits let it. A step can also join another: it was queued, or it was sent within 50 ms after the
// last one was due. Such a step runs evenly to its end, if the next one is queued behind it or may still come
// in time because the step is short (kStream_s in motion.cc). So a client that streams its path in steps gets
// that path, not stop and go. A longer step with nothing queued behind it comes to rest at its end. A stream
// that ends at speed passes its last target by its braking way, and comes back.
//
// A cosine loop goes between the place where it began and its target for ever, x(t) = a + (b - a) (1 - cos(2
// pi t/T))/2: it begins and turns at rest. A drive that moves stops first. A period that is too short for the
// limits of speed and acceleration becomes as long as they demand, anew in each turn.
//
// Plain values and pure functions.
#pragma once

#include <cstdint>

#include "hwparts/drive/ramp.h"

namespace visum::drive {

enum class MotionKind : std::uint8_t {
  kNone,      // the ports command
  kRamp,      // goes to `target`
  kStep,      // goes to `target` in `remaining_s`
  kVelocity,  // goes with `target` [u]/s, until something else is commanded or a soft limit stops it
  kCurrent,   // gives the motor `target` A
  kCosine,    // goes to `target` and back within `duration_s`, for ever
};

inline bool goes_to_a_place(MotionKind kind) {
  return kind == MotionKind::kRamp || kind == MotionKind::kStep || kind == MotionKind::kCosine;
}

struct Motion {
  MotionKind kind = MotionKind::kNone;
  double target = 0.0;
  double speed = 0.0;            // [u]/s, >= 0, the highest; kStep that comes to rest: its trapezoid's
  double acceleration = 0.0;     // [u]/s², > 0
  double duration_s = 0.0;       // kStep: as commanded; kCosine: the period of this turn
  double remaining_s = 0.0;      // kStep: until it is due, negative once it is overdue; kCosine: of this turn
  bool goes_on = false;          // kStep: joins the one before; kCosine: turns, is no longer stopping
  bool in_progress = false;      // kStep: not done yet
  bool queued = false;           // kStep: another one waits, with the two fields below
  double next_target = 0.0;      // kCosine: where it began
  double next_duration_s = 0.0;  // kCosine: the period as commanded
  double still_s = 0.0;          // kCurrent: how long nothing has moved
};

struct MotionLimits {
  double speed;         // [u]/s
  double acceleration;  // [u]/s²
};

// Calls `visit` for every field once: saving and loading thus agree. StateWriter::put_run() needs it
// inlined.
template <typename State, typename Visit>
[[gnu::always_inline]] inline void visit_motion(State& m, Visit visit) {
  visit(m.kind), visit(m.target), visit(m.speed), visit(m.acceleration), visit(m.duration_s);
  visit(m.remaining_s), visit(m.goes_on), visit(m.in_progress);
  visit(m.queued), visit(m.next_target), visit(m.next_duration_s), visit(m.still_s);
}

// The motion of a step that starts at once. `before`: the motion in force until now; `from`: the setpoint.
Motion start_step(const Motion& before, const Setpoint& from, double target, double duration_s,
                  const MotionLimits& limits);
// Queues a step behind the running one, in place of a step that is queued already.
void queue_step(Motion& motion, double target, double duration_s);

// One tick of a step. `target`: motion.target, as far as the soft limits allow.
Setpoint step_on(Motion& motion, const Setpoint& from, double target, const MotionLimits& limits,
                 double tick_s);

// The motion of a cosine loop between here and `target`.
Motion start_cosine(double target, double period_s, double acceleration);
// One tick of it.
Setpoint turn(Motion& motion, const Setpoint& from, const MotionLimits& limits, double tick_s);

// One tick of kCurrent: the setpoint follows the axis. Its phase shows motion until the axis has not moved
// for 0.1 s.
Setpoint follow_axis(Motion& motion, double position, double speed, bool moves, double tick_s);

}  // namespace visum::drive

// Motions that a module on a field bus is told to make, beside following the ports: ramps, steps with a
// queue of one, constant velocity, current. While one is in force, the drive does not look at the ports'
// desired value until that becomes another one.
//
// Steps ("be at p in t"). One by itself is a trapezoid that arrives, at rest, when it is due, or as soon as
// the limits let it. One that joins another (queued, or sent within 50 ms after the last was due) runs
// evenly to its end, so that a client that streams its path in steps gets that path, not stop and go. So it
// does where the next one is queued behind it, or may still come in time: a short one (kStream_s in
// motion.cc). A longer one that nothing is queued behind comes to rest at its end. A stream that ends at
// speed passes its last target by its braking way, and comes back.
#pragma once

#include <cstdint>

#include "hwparts/drive/ramp.h"

namespace visum::drive {

enum class MotionKind : std::uint8_t {
  kNone,      // the ports command
  kRamp,      // to `target`
  kStep,      // to `target` in `remaining_s`
  kVelocity,  // with `target` [u]/s, until something else is commanded or a soft limit stops it
  kCurrent,   // with `target` A
};

inline bool goes_to_a_place(MotionKind kind) {
  return kind == MotionKind::kRamp || kind == MotionKind::kStep;
}

struct Motion {
  MotionKind kind = MotionKind::kNone;
  double target = 0.0;
  double speed = 0.0;         // [u]/s, >= 0: at most; kStep that comes to rest: of its trapezoid
  double acceleration = 0.0;  // [u]/s², > 0
  double duration_s = 0.0;    // kStep: as asked for
  double remaining_s = 0.0;   // kStep: until it is due; below 0: overdue by that
  bool goes_on = false;       // kStep: joins the one before
  bool in_progress = false;   // kStep: not done yet
  bool queued = false;        // kStep: with the two below
  double next_target = 0.0;
  double next_duration_s = 0.0;
  double still_s = 0.0;  // kCurrent: for so long nothing has moved
};

struct MotionLimits {
  double speed;         // [u]/s
  double acceleration;  // [u]/s²
};

// Every field, once, for saving and loading.
template <typename State, typename Visit>
void visit_motion(State& m, Visit visit) {
  visit(m.kind), visit(m.target), visit(m.speed), visit(m.acceleration), visit(m.duration_s);
  visit(m.remaining_s), visit(m.goes_on), visit(m.in_progress);
  visit(m.queued), visit(m.next_target), visit(m.next_duration_s), visit(m.still_s);
}

// Starts a step at once. `before`: what was in force; `from`: where the setpoint is.
Motion start_step(const Motion& before, const Setpoint& from, double target, double duration_s,
                  const MotionLimits& limits);
// Queues a step behind the running one; a queued one is replaced.
void queue_step(Motion& motion, double target, double duration_s);

// One tick of a step. `target`: motion.target as far as the soft limits let it go.
Setpoint step_on(Motion& motion, const Setpoint& from, double target, const MotionLimits& limits,
                 double tick_s);

// One tick of kCurrent: the setpoint follows the axis; the phase tells whether it `moves`.
Setpoint follow_axis(Motion& motion, double position, double speed, bool moves, double tick_s);

}  // namespace visum::drive

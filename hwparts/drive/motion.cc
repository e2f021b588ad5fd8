#include "hwparts/drive/motion.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "protocol/config/trig.h"

namespace visum::drive {
namespace {

constexpr double kPi = 4.0 * config::kQuarterPi;
constexpr double kStill_s = 0.1;  // without motion for this long, the axis stands
// Streamed steps have periods of 10 to 50 ms. These are the longest gap to the next one, and their longest
// duration.
constexpr double kJoin_s = 0.05, kStream_s = 0.1;

// The cruising speed of a trapezoid that starts with speed u (> 0: towards the target) and is at rest after
// `distance` in `time`. Where the limits do not allow to be that soon, it is the highest allowed speed.
double cruise_speed(double distance, double u, double time, const MotionLimits& limits) {
  const double a = limits.acceleration;
  // Accelerating to v and braking:  v² - v (a t + u) + a d + u²/2 = 0
  const double sum = a * time + u;
  const double discriminant = sum * sum - 4.0 * (a * distance + 0.5 * u * u);
  if (sum <= 0.0 || discriminant < 0.0) return limits.speed;
  const double v = 0.5 * (sum - std::sqrt(discriminant));
  if (v >= u) return std::min(v, limits.speed);
  // Slowing down to v:  u²/2a + v (t - u/a) = d
  const double rest = time - u / a;
  const double slower = rest > 0.0 ? (distance - 0.5 * u * u / a) / rest : limits.speed;
  return slower > 0.0 ? std::min(slower, limits.speed) : limits.speed;
}

// One tick at the even speed that reaches `target` in `remaining_s`, as far as the limits allow.
Setpoint run_evenly(const Setpoint& from, double target, double remaining_s, const MotionLimits& limits,
                    double tick_s) {
  const double wanted = (target - from.position) / std::max(remaining_s, tick_s);
  const double change = limits.acceleration * tick_s;
  const double lower = std::max(-limits.speed, from.speed - change);
  const double upper = std::min(limits.speed, from.speed + change);
  const double speed = lower < upper ? std::clamp(wanted, lower, upper) : std::clamp(wanted, upper, lower);
  const bool arrives = remaining_s <= tick_s && speed == wanted;
  return {arrives ? target : from.position + speed * tick_s, speed, phase_of(from.speed, speed)};
}

// The shortest period of a cosine loop over a way d:  d pi/T <= v,  2 d (pi/T)² <= a
double shortest_turn(double d, const MotionLimits& limits) {
  return std::max(kPi * d / limits.speed, kPi * std::sqrt(2.0 * d / limits.acceleration));
}

}  // namespace

Motion start_step(const Motion& before, const Setpoint& from, double target, double duration_s,
                  const MotionLimits& limits) {
  Motion step;
  step.kind = MotionKind::kStep;
  step.target = target;
  step.duration_s = step.remaining_s = duration_s;
  step.in_progress = true;
  step.goes_on = before.kind == MotionKind::kStep && -before.remaining_s < std::min(duration_s, kJoin_s);
  step.acceleration = limits.acceleration;
  const double direction = target >= from.position ? 1.0 : -1.0;
  step.speed = cruise_speed(std::abs(target - from.position), direction * from.speed, duration_s, limits);
  return step;
}

void queue_step(Motion& motion, double target, double duration_s) {
  motion.queued = true;
  motion.next_target = target;
  motion.next_duration_s = duration_s;
}

Setpoint step_on(Motion& motion, const Setpoint& from, double target, const MotionLimits& limits,
                 double tick_s) {
  const double remaining_s = motion.remaining_s;
  motion.remaining_s -= tick_s;
  const bool streams = motion.goes_on && (motion.queued || motion.duration_s <= kStream_s);
  const bool evenly = streams && remaining_s > 0.5 * tick_s;
  const double speed = streams || remaining_s <= 0.0 ? limits.speed : motion.speed;
  const auto setpoint = evenly ? run_evenly(from, target, remaining_s, limits, tick_s)
                               : ramp_to(from, target, speed, limits.acceleration, tick_s);
  const bool due = motion.remaining_s < 0.5 * tick_s;
  const bool arrived = setpoint.position == target;
  if (due && motion.queued) {
    motion = start_step(motion, setpoint, motion.next_target, motion.next_duration_s, limits);
  } else if (due && arrived) {
    motion.in_progress = false;
  }
  return setpoint;
}

Motion start_cosine(double target, double period_s, double acceleration) {
  Motion loop;
  loop.kind = MotionKind::kCosine;
  loop.target = target;
  loop.acceleration = acceleration;
  loop.next_duration_s = period_s;
  return loop;
}

Setpoint turn(Motion& motion, const Setpoint& from, const MotionLimits& limits, double tick_s) {
  if (!motion.goes_on && from.speed != 0.0) return ramp_stop(from, limits.acceleration, tick_s);
  if (!std::exchange(motion.goes_on, true)) motion.next_target = from.position;
  const double way = motion.target - motion.next_target;
  if (motion.remaining_s < 0.5 * tick_s) {
    const double period = std::max(motion.next_duration_s, shortest_turn(std::abs(way), limits));
    if (way == 0.0 || period < tick_s || !std::isfinite(period)) return {from.position, 0.0, RampPhase::kEnd};
    motion.duration_s = period;
    motion.remaining_s += period;
  }
  motion.remaining_s -= tick_s;
  const double rate = 2.0 * kPi / motion.duration_s;
  const auto angle = config::sin_cos(rate * (motion.duration_s - motion.remaining_s));
  const double speed = 0.5 * way * rate * angle.sin;
  const auto phase = phase_of(from.speed, speed);
  return {motion.next_target + 0.5 * way * (1.0 - angle.cos), speed,
          phase == RampPhase::kEnd ? RampPhase::kSteady : phase};
}

Setpoint follow_axis(Motion& motion, double position, double speed, bool moves, double tick_s) {
  motion.still_s = moves ? 0.0 : motion.still_s + tick_s;
  return {position, speed, motion.still_s < kStill_s ? RampPhase::kSteady : RampPhase::kEnd};
}

}  // namespace visum::drive

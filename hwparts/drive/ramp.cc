#include "hwparts/drive/ramp.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace visum::drive {
namespace {

// A way forward along one axis: changes the speed to `cruise`, keeps it, then brakes to a stop.
struct Profile {
  double first_acceleration;
  double first_s, cruise_s, last_s;
  double cruise;  // >= 0
};

// The profile from speed u (any sign) over `distance` to a stop. The caller makes sure that a stop from u at
// full brake does not lead beyond the distance.
Profile plan(double distance, double u, double maximum_speed, double a) {
  Profile profile;
  if (u > maximum_speed) {
    profile.first_acceleration = -a;
    profile.cruise = maximum_speed;
  } else {  // accelerate to v and brake at once: (v² - u²) / 2a + v² / 2a = distance
    profile.first_acceleration = a;
    profile.cruise = std::min(maximum_speed, std::sqrt(std::max(0.0, a * distance + 0.5 * u * u)));
  }
  profile.first_s = std::max(0.0, (profile.cruise - u) / profile.first_acceleration);
  profile.last_s = profile.cruise / a;
  const double first_way = 0.5 * (u + profile.cruise) * profile.first_s;
  const double cruise_way = std::max(0.0, distance - first_way - 0.5 * profile.cruise * profile.last_s);
  const bool barred = maximum_speed == 0.0 && distance > 0.0;
  profile.cruise_s = profile.cruise > 0.0 ? cruise_way / profile.cruise
                     : barred             ? std::numeric_limits<double>::infinity()
                                          : 0.0;
  return profile;
}

struct Waypoint {
  double way = 0.0;
  double speed = 0.0;
};

// Where the profile is after t seconds. t is less than its whole duration.
Waypoint sample(const Profile& profile, double u, double a, double t) {
  const double first = std::min(t, profile.first_s);
  Waypoint motion{(u + 0.5 * profile.first_acceleration * first) * first,
                  u + profile.first_acceleration * first};
  t -= first;
  if (t <= 0.0) return motion;
  const double cruise = std::min(t, profile.cruise_s);
  motion = {motion.way + profile.cruise * cruise, profile.cruise};
  t -= cruise;
  if (t <= 0.0) return motion;
  return {motion.way + (profile.cruise - 0.5 * a * t) * t, std::max(0.0, profile.cruise - a * t)};
}

}  // namespace

RampPhase phase_of(double before, double after) {
  if (after == 0.0 && before == 0.0) return RampPhase::kEnd;
  if (std::abs(after) == std::abs(before)) return RampPhase::kSteady;
  return std::abs(after) > std::abs(before) ? RampPhase::kAccelerating : RampPhase::kDecelerating;
}

Setpoint ramp_to(const Setpoint& from, double target, double maximum_speed, double acceleration,
                 double tick_s) {
  const double stops_at = from.position + 0.5 * from.speed * std::abs(from.speed) / acceleration;
  const double direction = target >= stops_at ? 1.0 : -1.0;
  const double u = direction * from.speed;
  const Profile profile = plan(direction * (target - from.position), u, maximum_speed, acceleration);
  constexpr double kRounding = 1.0 + 1e-9;  // a rest of time that only rounding left takes no extra tick
  if (profile.first_s + profile.cruise_s + profile.last_s <= tick_s * kRounding)
    return {target, 0.0, RampPhase::kEnd};
  const Waypoint motion = sample(profile, u, acceleration, tick_s);
  const double speed = direction * motion.speed;
  return {from.position + direction * motion.way, speed, phase_of(from.speed, speed)};
}

Setpoint ramp_stop(const Setpoint& from, double deceleration, double tick_s) {
  const double direction = from.speed >= 0.0 ? 1.0 : -1.0;
  const double speed = std::abs(from.speed);
  if (speed <= deceleration * tick_s) {
    return {from.position + direction * 0.5 * speed * speed / deceleration, 0.0, RampPhase::kEnd};
  }
  const double after = speed - deceleration * tick_s;
  return {from.position + direction * 0.5 * (speed + after) * tick_s, direction * after,
          RampPhase::kDecelerating};
}

}  // namespace visum::drive

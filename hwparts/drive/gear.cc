#include "hwparts/drive/gear.h"

#include <algorithm>
#include <cmath>

#include "hwparts/drive/friction.h"

namespace visum::drive {
namespace {

constexpr double kAtRest = 1e-6;  // a rotor with this share of the momentum that dry friction takes away in a
                                  // tick stands: an engine finds speeds only so well

bool rigid(const GearData& gear) {
  return gear.stiffness == 0.0;
}

double sign(double x) {
  return x < 0.0 ? -1.0 : 1.0;
}

// The plan of a rotor with dry friction: it sticks, or it slides. `momentum` is J ω + h τm, `brake` [F] the
// part of the friction that a closed brake has.
RotorPlan with_dry_friction(const DriveData& data, const DriveState& state, double momentum, double brake,
                            double inertia, double tick_s) {
  RotorPlan plan;
  plan.dry = true;
  plan.slide_mobility = tick_s / inertia;
  plan.friction = data.gear.dry_friction + brake;
  plan.breakaway = data.gear.static_friction + brake;
  plan.push = momentum / tick_s;
  const double moving = momentum - tick_s * state.gear_effort;
  const bool rests =
      data.reflected_inertia() * std::abs(state.rotor_speed) <= kAtRest * tick_s * plan.breakaway;
  const double holds = rests ? plan.breakaway : plan.friction;
  if (std::abs(moving) <= tick_s * holds) return plan;
  plan.sliding = sign(moving);
  plan.mobility = plan.slide_mobility;
  plan.free_speed = (momentum - tick_s * plan.friction * plan.sliding) / inertia;
  return plan;
}

// True if the gear touches a flank of its backlash at each joint, and will not leave it in this tick as it
// moves now.
bool stays_engaged(const GearData& gear, const DriveState& state,
                   std::span<const hwparts::JointSample> joints, double tick_s) {
  if (rigid(gear) || gear.backlash == 0.0) return true;
  const double n = static_cast<double>(joints.size());
  return std::ranges::all_of(joints, [&](const hwparts::JointSample& joint) {
    const double torsion = state.rotor_position - n * joint.position;
    const double way = tick_s * (state.rotor_speed - n * joint.velocity);
    return std::abs(torsion) - std::abs(way) > 0.5 * gear.backlash;
  });
}

// The place within the tick for what has the rate x/h, by (5).
double place_of(double x) {
  return 0.5 + x / (12.0 + 2.0 * x);
}

// The rotor's speed at ϑh, for the secant of friction there. A change is believed up to half of the speed:
// where efforts jump, the joint's inertia, which is not known here, makes the true one smaller.
double expected_speed(const DriveData& data, const DriveState& state, const MotorEffort& motor,
                      double time_s) {
  const double speed = state.rotor_speed, most = 0.5 * std::abs(speed);
  const double effort = motor.effort - friction_effort(data.gear, speed) - state.gear_effort;
  return speed + std::clamp(time_s * effort / data.reflected_inertia(), -most, most);
}

// The flank of the backlash that the motion runs towards, -1 or +1: the one it touches, unless it will have
// crossed the play by the tick's end.
double flank(double torsion, double predicted, double half_play) {
  if (torsion > half_play) return predicted < -half_play ? -1.0 : 1.0;
  if (torsion < -half_play) return predicted > half_play ? 1.0 : -1.0;
  return sign(predicted);
}

// The value at the tick's end of what is `now` at its start and `then` at ϑh.
double at_the_end(double then, double now, double place) {
  return place == 1.0 ? then : now + (then - now) / place;
}

// For a rigid gear the rotor is where the joint is, and dry friction holds both.
hwparts::JointDrive couple_rigidly(const RotorPlan& plan, double most_effort, double n, double speed) {
  if (plan.mobility == 0.0) return {0.0, 0.0, plan.breakaway, plan.push};
  return {at_the_end(plan.free_speed / n, speed, plan.place), plan.mobility / n / plan.place, most_effort,
          0.0};
}

// The effort at the module. Each of n joints feels n times its share of it.
double total_effort(std::span<const hwparts::JointSample> joints) {
  double sum = 0.0;
  for (const auto& joint : joints) sum += joint.effort;
  return sum / static_cast<double>(joints.size());
}

// ω_ϑ by (1), or by dry friction.
double speed_in_tick(const RotorPlan& plan, double effort) {
  const double speed = plan.free_speed - plan.mobility * effort;
  if (!plan.dry) return speed;
  if (plan.sliding != 0.0) return speed * plan.sliding > 0.0 ? speed : 0.0;
  const double load = plan.push - effort;
  if (std::abs(load) <= plan.breakaway) return 0.0;
  return sign(load) * plan.slide_mobility * (std::abs(load) - plan.friction);
}

void follow_joints(std::span<const hwparts::JointSample> joints, DriveState& state) {
  state.rotor_position = state.rotor_speed = 0.0;
  for (const auto& joint : joints) {
    state.rotor_position += joint.position;
    state.rotor_speed += joint.velocity;
  }
}

}  // namespace

RotorPlan plan_rotor(const DriveData& data, const DriveState& state, const MotorEffort& motor,
                     bool brake_holds, std::span<const hwparts::JointSample> joints, bool moved_by_mean_speed,
                     double tick_s) {
  const bool dry = brake_holds || data.gear.static_friction > 0.0;
  const bool by_mean_speed = moved_by_mean_speed && !dry;
  const double speed = state.rotor_speed, j = data.reflected_inertia();
  double place = 1.0, spring_place = 1.0, slowed = speed;
  if (by_mean_speed) {
    const double y = tick_s * (data.gear.damping + friction_secant(data.gear, 0.0) + motor.damping) / j;
    place = place_of(y);
    if (stays_engaged(data.gear, state, joints, tick_s))
      spring_place = place_of(y + tick_s * std::sqrt(data.gear.stiffness / j));
    slowed = expected_speed(data, state, motor, place * tick_s);
  }
  const double time = place * tick_s;
  const double inertia = j + time * (friction_secant(data.gear, slowed) + motor.damping);
  const double effort = motor.effort + motor.damping * speed;  // at standstill, on the same slope
  const double momentum = j * speed + time * effort;
  if (dry) {
    const double brake = brake_holds ? data.brake.holding_effort : 0.0;
    return with_dry_friction(data, state, momentum, brake, inertia, tick_s);
  }
  return {momentum / inertia, time / inertia, place, spring_place, by_mean_speed};
}

hwparts::JointDrive couple(const DriveData& data, const RotorPlan& plan, double rotor_position,
                           double most_effort, std::size_t share, const hwparts::JointSample& joint,
                           double tick_s) {
  const auto& gear = data.gear;
  const double n = static_cast<double>(share);
  if (rigid(gear)) return couple_rigidly(plan, most_effort, n, joint.velocity);
  const double k = gear.stiffness / n;
  const double kappa = plan.spring_place * tick_s * k + gear.damping / n;
  const double c = (1.0 / kappa + n * plan.mobility) / (n * n) / plan.place;  // at the joint
  const double torsion = rotor_position - n * joint.position;
  const auto target = [&](double stretch) {
    return at_the_end((plan.free_speed + k * stretch / kappa) / n, joint.velocity, plan.place);
  };
  if (gear.backlash == 0.0) return {target(torsion), c, most_effort, 0.0};

  const double half_play = 0.5 * gear.backlash;
  const double predicted = torsion + tick_s * (plan.free_speed - n * joint.velocity);
  const double side = flank(torsion, predicted, half_play);
  const double half_limit = 0.5 * most_effort;
  return {target(torsion - side * half_play) - c * side * half_limit, c, half_limit, side * half_limit};
}

void move_rotor(const DriveData& data, const RotorPlan& plan, std::span<const hwparts::JointSample> joints,
                double tick_s, DriveState& state) {
  state.gear_effort = total_effort(joints);
  if (rigid(data.gear)) return follow_joints(joints, state);
  const double before = state.rotor_speed;
  state.rotor_speed = at_the_end(speed_in_tick(plan, state.gear_effort), before, plan.place);
  const double moving = plan.by_mean_speed ? 0.5 * (before + state.rotor_speed) : state.rotor_speed;
  state.rotor_position += tick_s * moving;
}

void slip_gear(const DriveData& data, std::span<const hwparts::JointSample> joints, double slip_effort,
               DriveState& state) {
  if (rigid(data.gear) || !(slip_effort < data.gear.breaking_effort)) return;
  double torsion = state.rotor_position;
  for (const auto& joint : joints) torsion -= joint.position;
  const double most = 0.5 * data.gear.backlash + slip_effort / data.gear.stiffness;
  const double steps = std::floor((std::abs(torsion) - most) / data.increment());
  if (!(steps > 0.0)) return;
  const double shift = sign(torsion) * steps * data.increment();
  state.rotor_position -= shift;
  state.zero_offset += shift;
}

}  // namespace visum::drive

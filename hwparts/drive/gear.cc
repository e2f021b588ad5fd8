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

// The place within the tick for what has the rate x/h, by (5).
double place_of(double x) {
  return 1.0 - 3.0 / (6.0 + x);
}

// The rotor's speed `time_s` later, for the secant of friction there. A change is believed up to half of the
// speed: where efforts jump, the joint's inertia makes the true one smaller.
double expected_speed(const DriveData& data, const DriveState& state, const MotorEffort& motor,
                      double friction, double time_s) {
  const double speed = state.rotor_speed, most = 0.5 * std::abs(speed);
  const double effort = motor.effort - friction * speed - state.gear_effort;
  return speed + std::clamp(time_s * effort / data.reflected_inertia(), -most, most);
}

// The flank of the backlash that the motion runs towards, -1 or +1: the one it touches, unless it will have
// crossed the play by the tick's end.
double flank(double torsion, double predicted, double half_play) {
  if (torsion > half_play) return predicted < -half_play ? -1.0 : 1.0;
  if (torsion < -half_play) return predicted > half_play ? 1.0 : -1.0;
  return sign(predicted);
}

// For a rigid gear the rotor is where the joint is, and dry friction holds both.
hwparts::JointDrive couple_rigidly(const RotorPlan& plan, double most_effort, double n) {
  if (plan.mobility == 0.0) return {0.0, 0.0, plan.breakaway, plan.push};
  return {plan.free_speed / n, plan.mobility / n, most_effort, 0.0};
}

// The effort at the module. Each of n joints feels n times its share of it.
double total_effort(std::span<const hwparts::JointSample> joints) {
  double sum = 0.0;
  for (const auto& joint : joints) sum += joint.effort;
  return sum / static_cast<double>(joints.size());
}

// ω⁺ by (1), or by dry friction.
double next_speed(const RotorPlan& plan, double effort) {
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

GearPlaces places_of(const DriveData& data, const Load& load, double tick_s) {
  const auto& gear = data.gear;
  if (rigid(gear) || !load.moves_by_mean_speed) return {};
  const double of_link = load.inertia > 0.0 ? 1.0 / load.inertia : 0.0;
  const double of_both = 1.0 / data.reflected_inertia() + of_link;  // 1/m
  const double damped = tick_s * gear.damping * of_both;
  return {place_of(damped), place_of(damped + tick_s * std::sqrt(gear.stiffness * of_both))};
}

RotorPlan plan_rotor(const DriveData& data, const DriveState& state, const MotorEffort& motor,
                     bool brake_holds, bool joints_move_by_mean_speed, double tick_s) {
  const bool dry = brake_holds || data.gear.static_friction > 0.0;
  const double speed = state.rotor_speed, j = data.reflected_inertia();
  double friction = friction_secant(data.gear, speed), place = 1.0;
  const bool by_mean_speed = joints_move_by_mean_speed && !dry;
  if (by_mean_speed) {
    place = place_of(tick_s * (friction + motor.damping) / j);
    friction = friction_secant(data.gear, expected_speed(data, state, motor, friction, place * tick_s));
  }
  const double slope = tick_s * (friction + motor.damping);
  const double inertia = j + place * slope;
  const double effort = motor.effort + motor.damping * speed;  // at standstill, on the same slope
  const double momentum = j * speed + tick_s * effort - (1.0 - place) * slope * speed;
  if (dry) {
    const double brake = brake_holds ? data.brake.holding_effort : 0.0;
    return with_dry_friction(data, state, momentum, brake, inertia, tick_s);
  }
  return {momentum / inertia, tick_s / inertia, by_mean_speed};
}

hwparts::JointDrive couple(const DriveData& data, const RotorPlan& plan, const DriveState& state,
                           const GearPlaces& places, double most_effort, std::size_t share,
                           const hwparts::JointSample& joint, double tick_s) {
  const auto& gear = data.gear;
  const double n = static_cast<double>(share);
  if (rigid(gear)) return couple_rigidly(plan, most_effort, n);
  const double torsion = state.rotor_position - n * joint.position;
  const double rate = state.rotor_speed - n * joint.velocity;
  GearPlaces at;
  if (plan.by_mean_speed) {
    at = places;
    const bool stays = std::abs(torsion) - tick_s * std::abs(rate) > 0.5 * gear.backlash;
    if (gear.backlash > 0.0 && !stays) at.spring = 1.0;
  }
  const double k = gear.stiffness / n;
  const double all = at.spring * tick_s * k + gear.damping / n, kappa = at.damper * all;  // κ, ϑκ
  const double c = (1.0 / kappa + n * plan.mobility) / (n * n);                           // at the joint
  const double carried = (1.0 - at.damper) * all * rate;
  const auto target = [&](double stretch) { return (plan.free_speed + (k * stretch + carried) / kappa) / n; };
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
  state.rotor_speed = next_speed(plan, state.gear_effort);
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

// Springs with dampers, between two points or about an axis.
//
// Symbols: k stiffness, d damping, l length (or angle) at t, l0 length without load, q~ mean rate of the
// length in the look-ahead, L impulse at t (and the same again at t+h), h step.
//   F = -k (l + h q~/2 - l0) - d q~,  L = h F/2                 the force at the middle of the step
//   q~ + 2/(h g) L = -k (l - l0)/g,  g = k h/2 + d              as a row
// This is the implicit midpoint rule: second order, the same backwards in time, stable at any k; only d takes
// energy. q~ is how the length really changes. The velocity at t along the direction at t would differ,
// because the spring turns and bodies fall. The look-aheads find this difference, as they do with the gaps of
// joints. A spring about a hinge's own axis, or along a slider's, is a law of that axis (axes.cc), in the
// tree: there q~ is the axis' own, and no row is needed. It is out of the tree at t+h, where its impulse is
// known, and in hits.
// Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, II.1.
#include <numbers>

#include "server/dynamics/impulse/plant.h"

namespace visum::dynamics::impulse {
namespace {

constexpr double kNoLengthM = 1e-12;  // a shorter spring has no direction
constexpr double kHalfTurn = std::numbers::pi;

// m, or rad for a torsion spring, unwrapped to the turn that is nearest to `last`.
double length_of(const JointSpec& spec, const JointPose& pose, double last) {
  return spec.kind == world::JointKind::kTorsionSpring ? joint_angle(spec, pose, last)
                                                       : (pose.pb - pose.pa).norm();
}

// Length and direction of a spring in the bodies' present poses.
void measure(Spring& spring, const Bodies& bodies, const world::WorldState& state) {
  const JointSpec& spec = spring.spec;
  const double last = state.joints[spec.id.index()].position;
  const JointPose pose = pose_now(spec, bodies, last);
  spring.length = length_of(spec, pose, last);
  Vector3d w = Vector3d::Zero(), v = Vector3d::Zero();
  if (spec.kind == world::JointKind::kTorsionSpring) {
    w = pose.a;
  } else if (spring.length > kNoLengthM) {
    v = (pose.pb - pose.pa) / spring.length;
  }
  spring.pull = {w, v, pose.pa, pose.pb};
  spring.acts =
      (spec.model->stiffness > 0.0 || spec.model->damping > 0.0) && !(w.isZero(0.0) && v.isZero(0.0));
  spring.impulse = 0.0;
}

// The same of a spring that is a law of its axis.
void measure_on_axis(Spring& spring, const Axis& axis, const world::WorldState& state) {
  spring.impulse = 0.0;
  if (!axis.turns) {
    const double along = axis.start + spring.offset;
    spring.sense = along < 0.0 ? -1.0 : 1.0;
    spring.length = std::abs(along);
    return;
  }
  spring.length = spring.sense * axis.start + spring.offset;
  const double off = state.joints[spring.spec.id.index()].position - spring.length;
  if (std::abs(off) >= kHalfTurn) spring.length += 2.0 * kHalfTurn * std::round(off / (2.0 * kHalfTurn));
}

// The look-ahead gave the impulse of spring and damping together; the mean rate says how much is whose.
// Without damping all of it is the spring's, to the bit, so that a step back is the same.
void repeat_on_axis(Spring& spring, Axis& axis, double h) {
  const world::Joint& model = *spring.spec.model;
  spring.mean_rate = spring.sense * axis.mean_rate;
  const double stretch = spring.length + 0.5 * h * spring.mean_rate - model.rest;
  axis.repeated = axis.damping == 0.0 ? axis.damped[kAhead]
                                      : -0.5 * h * spring.sense *
                                            (model.stiffness * stretch + model.damping * spring.mean_rate);
  axis.damped[kAhead] -= axis.repeated;
  spring.impulse = spring.sense * axis.repeated;
}

}  // namespace

bool is_asleep(const Plant& plant, const Spring& spring) {
  return plant.asleep[static_cast<std::size_t>(spring.spec.b)] != 0;
}

void measure_springs(Plant& plant, std::size_t island, const world::WorldState& state) {
  for (const std::size_t i : plant.islands.springs(island)) {
    Spring& spring = plant.springs[i];
    if (!plant.is_loose(spring)) {
      measure_on_axis(spring, plant.axes[spring.axis], state);
      continue;
    }
    measure(spring, plant.bodies, state);
    spring.acts = spring.acts && !is_asleep(plant, spring);
  }
}

void measure_springs_ahead(Plant& plant, std::size_t island, const world::WorldState& state, double h) {
  for (const std::size_t i : plant.islands.springs(island)) {
    Spring& spring = plant.springs[i];
    if (!spring.acts || !plant.is_loose(spring)) continue;
    const JointPose ahead = pose_ahead(spring.spec, plant.bodies, state.joints[spring.spec.id.index()], h);
    spring.mean_rate = (length_of(spring.spec, ahead, spring.length) - spring.length) / h;
  }
}

void push_by_springs(Plant& plant, std::size_t island, const world::WorldState& state, double h) {
  Bodies& bodies = plant.bodies;
  for (const std::size_t number : plant.islands.springs(island)) {
    Spring& spring = plant.springs[number];
    if (!plant.is_loose(spring)) {
      if (!is_asleep(plant, spring)) repeat_on_axis(spring, plant.axes[spring.axis], h);
      spring.total += 2.0 * spring.impulse;
      continue;
    }
    const double impulse = spring.impulse;
    measure(spring, bodies, state);
    spring.impulse = impulse;  // the energy guard needs it
    spring.total += 2.0 * impulse;
    if (impulse == 0.0) continue;
    const Pull& pull = spring.pull;
    const auto push = [&](int body, double sign, const Vector3d& p) {
      if (body < 0) return;
      const auto i = static_cast<std::size_t>(body);
      bodies.v[i] += sign * impulse * bodies.constants[i].inverse_mass * pull.v;
      bodies.w[i] +=
          sign * impulse * (bodies.inverse_inertia[i] * (pull.w + (p - bodies.x[i]).cross(pull.v)));
    };
    push(spring.spec.a, -1.0, pull.pa);
    push(spring.spec.b, 1.0, pull.pb);
  }
}

}  // namespace visum::dynamics::impulse

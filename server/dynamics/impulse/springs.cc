// Springs with dampers, between two points or about an axis.
//
// Symbols: k stiffness, d damping, l length (or angle) at t, l0 length without load, q~ mean rate of the
// length in the look-ahead, L impulse at t (and the same again at t+h), h step.
//   F = -k (l + h q~/2 - l0) - d q~,  L = h F/2                 the force at the middle of the step
//   q~ + 2/(h g) L = -k (l - l0)/g,  g = k h/2 + d              as a row
// This is the implicit midpoint rule: second order, the same backwards in time, stable at any k; only d takes
// energy. q~ is how the length really changes. The velocity at t along the direction at t would differ,
// because the spring turns and bodies fall. The look-aheads find this difference, as they do with the gaps of
// joints. Source: Hairer, Lubich, Wanner, Geometric Numerical Integration, II.1.
#include "server/dynamics/impulse/plant.h"

namespace visum::dynamics::impulse {
namespace {

constexpr double kNoLengthM = 1e-12;  // a shorter spring has no direction

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

}  // namespace

bool is_asleep(const Plant& plant, const Spring& spring) {
  return plant.asleep[static_cast<std::size_t>(spring.spec.b)] != 0;
}

void measure_springs(Plant& plant, std::size_t island, const world::WorldState& state) {
  for (const std::size_t i : plant.islands.springs(island)) {
    Spring& spring = plant.springs[i];
    measure(spring, plant.bodies, state);
    spring.acts = spring.acts && !is_asleep(plant, spring);
  }
}

void measure_springs_ahead(Plant& plant, std::size_t island, const world::WorldState& state, double h) {
  for (const std::size_t i : plant.islands.springs(island)) {
    Spring& spring = plant.springs[i];
    if (!spring.acts) continue;
    const JointPose ahead = pose_ahead(spring.spec, plant.bodies, state.joints[spring.spec.id.index()], h);
    spring.mean_rate = (length_of(spring.spec, ahead, spring.length) - spring.length) / h;
  }
}

void push_by_springs(Plant& plant, std::size_t island, const world::WorldState& state) {
  Bodies& bodies = plant.bodies;
  for (const std::size_t number : plant.islands.springs(island)) {
    Spring& spring = plant.springs[number];
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

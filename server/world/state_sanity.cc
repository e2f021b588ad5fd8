#include <cmath>
#include <cstring>

#include "server/world/fault_text.h"
#include "server/world/world_state.h"

namespace visum::world {
namespace {

constexpr double kQuaternionDrift = 1e-3;  // amply more than an engine leaves between two normalisations

const char* body_offence(const BodyState& body) {
  if (!is_placed(body.p_WC)) return "has a position that is not finite or beyond 1e6 m";
  if (!(std::abs(body.q_WB.norm() - 1.0) <= kQuaternionDrift))
    return "has a quaternion that is not of unit length";
  if (!is_placed(body.v_WC)) return "has a velocity that is not finite or beyond 1e6 m/s";
  if (!is_placed(body.w_WB)) return "has an angular velocity that is not finite or beyond 1e6 rad/s";
  return nullptr;
}

// Two doubles in one vector register.
using Pair = double __attribute__((vector_size(16)));

Pair pair_at(const double* from) {
  Pair pair;
  std::memcpy(&pair, from, sizeof(pair));
  return pair;
}

// A fast first look: where the sums of squares over all bodies or joints are small, all are sane. That takes
// few instructions and no branches. A sum that is large or NaN decides nothing: then each one is looked at by
// itself.
bool are_quiet(std::span<const BodyState> bodies) {
  Pair sums{0.0, 0.0};
  double size = 0.0, drift = 0.0;
  for (const BodyState& body : bodies) {
    const Pair p = pair_at(body.p_WC.data()), v = pair_at(body.v_WC.data()), w = pair_at(body.w_WB.data());
    const Pair z{body.v_WC.z(), body.w_WB.z()};
    sums += (p * p + v * v) + (w * w + z * z);
    size += body.p_WC.z() * body.p_WC.z();
    const Pair q = pair_at(body.q_WB.coeffs().data()), r = pair_at(body.q_WB.coeffs().data() + 2);
    const Pair squares = q * q + r * r;
    const double beyond = (squares[0] + squares[1]) - 1.0;
    drift += beyond * beyond;
  }
  return (sums[0] + sums[1]) + size <= kMaxMagnitude * kMaxMagnitude &&
         drift <= kQuaternionDrift * kQuaternionDrift;
}

bool are_quiet(std::span<const JointState> joints) {
  double sum = 0.0;
  for (const JointState& joint : joints) {
    const Pair motion{joint.position, joint.velocity}, squares = motion * motion;
    sum += (squares[0] + squares[1]) + joint.effort * joint.effort;
  }
  return sum <= kMaxMagnitude * kMaxMagnitude;
}

const char* joint_offence(const JointState& joint) {
  if (!std::isfinite(joint.position) || !std::isfinite(joint.velocity))
    return "has a position or velocity that is not finite";
  if (!std::isfinite(joint.effort)) return "has an effort that is not finite";
  return nullptr;
}

bool report(const char* offence, const char* what, const std::string& name, std::string* offender) {
  if (offender != nullptr) *offender = what + quoted(name) + " " + offence;
  return false;
}

}  // namespace

bool is_sane(const WorldModel& model, const WorldState& state, std::string* offender) {
  const std::span bodies = std::span(state.bodies).first(model.bodies.size());
  const std::span joints = std::span(state.joints).first(model.joints.size());
  if (are_quiet(bodies) && are_quiet(joints)) return true;
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (const char* offence = body_offence(state.bodies[i]); offence != nullptr)
      return report(offence, "body ", model.bodies[i].name, offender);
  for (std::size_t i = 0; i < model.joints.size(); ++i)
    if (const char* offence = joint_offence(state.joints[i]); offence != nullptr)
      return report(offence, "joint ", model.joints[i].name, offender);
  return true;
}

}  // namespace visum::world

#include <cmath>

#include "server/world/fault_text.h"
#include "server/world/world_state.h"

namespace visum::world {
namespace {

constexpr double kQuaternionDrift = 1e-3;  // what an engine may leave between two normalisations, amply

const char* body_offence(const BodyState& body) {
  if (!is_placed(body.p_WC)) return "has a position that is not finite or beyond 1e6 m";
  if (!(std::abs(body.q_WB.norm() - 1.0) <= kQuaternionDrift))
    return "has a quaternion that is not of unit length";
  if (!is_placed(body.v_WC)) return "has a velocity that is not finite or beyond 1e6 m/s";
  if (!is_placed(body.w_WB)) return "has an angular velocity that is not finite or beyond 1e6 rad/s";
  return nullptr;
}

// Most of what is sane, by few instructions and no branches; the others are looked at one by one.
unsigned is_quiet(double value) {
  return std::abs(value) <= kMaxMagnitude ? 1u : 0u;
}

unsigned is_quiet(const Eigen::Vector3d& u) {
  return is_quiet(u.x()) & is_quiet(u.y()) & is_quiet(u.z());
}

bool is_quiet(const BodyState& body) {
  const unsigned is_unit = std::abs(body.q_WB.squaredNorm() - 1.0) <= kQuaternionDrift ? 1u : 0u;
  return (is_unit & is_quiet(body.p_WC) & is_quiet(body.v_WC) & is_quiet(body.w_WB)) != 0;
}

bool is_quiet(const JointState& joint) {
  return (is_quiet(joint.position) & is_quiet(joint.velocity) & is_quiet(joint.effort)) != 0;
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
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    if (is_quiet(state.bodies[i])) continue;
    if (const char* offence = body_offence(state.bodies[i]); offence != nullptr)
      return report(offence, "body ", model.bodies[i].name, offender);
  }
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    if (is_quiet(state.joints[i])) continue;
    if (const char* offence = joint_offence(state.joints[i]); offence != nullptr)
      return report(offence, "joint ", model.joints[i].name, offender);
  }
  return true;
}

}  // namespace visum::world

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

const char* joint_offence(const JointState& joint) {
  if (!std::isfinite(joint.position) || !std::isfinite(joint.velocity))
    return "has a position or velocity that is not finite";
  if (!std::isfinite(joint.effort)) return "has an effort that is not finite";
  return nullptr;
}

bool report(const char* offence, const char* what, const std::string& name, std::string* offender) {
  if (offence != nullptr && offender != nullptr) *offender = what + quoted(name) + " " + offence;
  return offence == nullptr;
}

}  // namespace

bool is_sane(const WorldModel& model, const WorldState& state, std::string* offender) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    if (!report(body_offence(state.bodies[i]), "body ", model.bodies[i].name, offender)) return false;
  }
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    if (!report(joint_offence(state.joints[i]), "joint ", model.joints[i].name, offender)) return false;
  }
  return true;
}

}  // namespace visum::world

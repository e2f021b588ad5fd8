#include "server/world/joint_kinds.h"
#include "server/world/joint_tree.h"
#include "server/world/world_state.h"

namespace visum::world {
namespace {

bool moves_its_child(const Joint& joint) {
  return is_drivable(joint.kind) && joint.initial_position != 0.0;
}

// The poses of the links with all initial positions applied. Each joint passes the displacement of its parent
// on to its child and adds its own. Joints stand parents first, so one pass is enough. A link that nothing
// displaces keeps the pose of the model to the bit.
std::vector<Pose> displaced_links(const WorldModel& model) {
  std::vector<Pose> links;
  for (const Body& body : model.bodies) links.push_back(body.X_WB);
  const std::vector<JointId> carrying = carrying_joints(model);
  std::vector<bool> displaced(model.bodies.size(), false);
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const Joint& joint = model.joints[i];
    const std::size_t child = joint.child.index();
    const bool with_parent = joint.parent.valid() && displaced[joint.parent.index()];
    if (carrying[child].index() != i || !(with_parent || moves_its_child(joint))) continue;
    const Pose X_WJ_old =
        (joint.parent.valid() ? model.bodies[joint.parent.index()].X_WB : Pose{}) * joint.X_PJ;
    const Pose X_WJ_new = (joint.parent.valid() ? links[joint.parent.index()] : Pose{}) * joint.X_PJ;
    links[child] =
        X_WJ_new * joint_motion(joint, joint.initial_position) * (X_WJ_old.inverse() * links[child]);
    displaced[child] = true;
  }
  return links;
}

BodyState body_state(const Body& body, const Pose& X_WB) {
  const Eigen::Vector3d p_BC_W = X_WB.q * body.p_BC;
  return {X_WB.p + p_BC_W, X_WB.q, body.v_WB + body.w_WB.cross(p_BC_W), body.w_WB};
}

// A curve may come near itself. The start decides which of its places is meant; measuring then follows that
// one.
double start_position(const Joint& joint) {
  if (joint.kind == JointKind::kPointOnCurve) return joint.curve_J.nearest(Eigen::Vector3d::Zero());
  return joint.initial_position;
}

}  // namespace

WorldState initial_state(const WorldModel& model) {
  WorldState state;
  const std::vector<Pose> links = displaced_links(model);
  state.bodies.reserve(model.bodies.size());
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    state.bodies.push_back(body_state(model.bodies[i], {links[i].p, links[i].q.normalized()}));
  state.joints.resize(model.joints.size());
  for (std::size_t i = 0; i < model.joints.size(); ++i)
    state.joints[i].position = start_position(model.joints[i]);
  state.engines.resize(model.engines.size());
  measure_joints(model, state);
  return state;
}

}  // namespace visum::world

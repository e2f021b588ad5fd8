#include "server/world/placing.h"

#include <algorithm>
#include <cmath>

#include "server/world/fault_text.h"
#include "server/world/joint_kinds.h"
#include "server/world/joint_tree.h"
#include "server/world/turn.h"

namespace visum::world {
namespace {

// The bodies that move with `root`, itself included, by BodyId.
std::vector<bool> moving_with(const WorldModel& model, const std::vector<JointId>& carrying, BodyId root) {
  std::vector<bool> moves(model.bodies.size(), false);
  moves[root.index()] = true;
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const Joint& joint = model.joints[i];
    if (carrying[joint.child.index()].index() == i && joint.parent.valid() && moves[joint.parent.index()])
      moves[joint.child.index()] = true;
  }
  return moves;
}

// A joint that holds one of the moving bodies to one that stays; null: there is none. `carrier` is the joint
// by which all of them hang.
const Joint* holding_back(const WorldModel& model, const std::vector<bool>& moves, JointId carrier) {
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const Joint& joint = model.joints[i];
    if (!info(joint.kind).holds_anything || (carrier.valid() && carrier.index() == i)) continue;
    const bool parent_moves = joint.parent.valid() && moves[joint.parent.index()];
    if (parent_moves != moves[joint.child.index()]) return &joint;
  }
  return nullptr;
}

BodyState state_of(const Body& body, const Placement& at) {
  const Eigen::Vector3d p_BC_W = at.X_WB.q * body.p_BC;
  return {at.X_WB.p + p_BC_W, at.X_WB.q.normalized(), at.v_WB + at.w_WB.cross(p_BC_W), at.w_WB};
}

// The child of a joint, as the joint's coordinate puts it against its parent.
Placement hung_on(const WorldModel& model, const WorldState& state, const Joint& joint, double position,
                  double velocity) {
  Placement parent;
  if (joint.parent.valid())
    parent = placement_of(model.bodies[joint.parent.index()], state.bodies[joint.parent.index()]);
  const Pose X_WJ = parent.X_WB * joint.X_PJ;
  Placement child;
  child.X_WB = X_WJ * joint_motion(joint, position) * joint.X_CJ.inverse();
  const Eigen::Vector3d axis_W = X_WJ.q * joint.axis_J;
  const bool turns = joint.kind != JointKind::kSlider;
  if (turns) child.w_WB = velocity * axis_W;
  const double along = joint.kind == JointKind::kScrew    ? screw_lift(joint, velocity)
                       : joint.kind == JointKind::kSlider ? velocity
                                                          : 0.0;
  // The velocity of the child's point at the joint, then of its origin, then with the parent's motion.
  const Eigen::Vector3d p_J = (child.X_WB * joint.X_CJ).p;
  child.v_WB = along * axis_W + child.w_WB.cross(child.X_WB.p - p_J) + parent.v_WB +
               parent.w_WB.cross(child.X_WB.p - parent.X_WB.p);
  child.w_WB += parent.w_WB;
  return child;
}

// Takes every body that moves along from where `root` was to where it is put.
void carry_along(const WorldModel& model, const std::vector<bool>& moves, BodyId root, const Placement& to,
                 WorldState& state) {
  const Placement from = placement_of(model.bodies[root.index()], state.bodies[root.index()]);
  const Pose moved = to.X_WB * from.X_WB.inverse();
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    if (!moves[i] || i == root.index()) continue;
    const Placement old = placement_of(model.bodies[i], state.bodies[i]);
    Placement now{moved * old.X_WB};
    const Eigen::Vector3d r_old = old.X_WB.p - from.X_WB.p, r_now = now.X_WB.p - to.X_WB.p;
    now.v_WB = to.v_WB + to.w_WB.cross(r_now) + moved.q * (old.v_WB - from.v_WB - from.w_WB.cross(r_old));
    now.w_WB = to.w_WB + moved.q * (old.w_WB - from.w_WB);
    state.bodies[i] = state_of(model.bodies[i], now);
  }
  state.bodies[root.index()] = state_of(model.bodies[root.index()], to);
}

void move_root(double tick_s, const BodyState& from, BodyState& body) {
  body = from;
  body.p_WC += tick_s * from.v_WC;
  const double speed = from.w_WB.norm();
  if (speed > 0.0) body.q_WB = (turn_about(from.w_WB / speed, tick_s * speed) * from.q_WB).normalized();
}

}  // namespace

Placement placement_of(const Body& body, const BodyState& state) {
  return {link_pose(body, state), link_velocity(body, state), state.w_WB};
}

std::string placing_fault(const WorldModel& model, BodyId id) {
  const Body& body = model.bodies[id.index()];
  if (body.fixed) return quoted(body.name) + " is fixed";
  const auto carrying = carrying_joints(model);
  if (const JointId joint = carrying[id.index()]; joint.valid())
    return quoted(body.name) + " hangs on the joint " + quoted(model.joints[joint.index()].name) +
           ": set the joint instead";
  const Joint* joint = holding_back(model, moving_with(model, carrying, id), {});
  return joint ? "the joint " + quoted(joint->name) + " holds " + quoted(body.name) : "";
}

std::string placing_fault(const WorldModel& model, const JointPlacement& to) {
  const Joint& joint = model.joints[to.joint.index()];
  const std::string name = "joint " + quoted(joint.name);
  if (!is_drivable(joint.kind)) return name + " has no position that could be set";
  const auto carrying = carrying_joints(model);
  if (carrying[joint.child.index()] != to.joint) return name + " closes a loop: it cannot be set";
  if (const Joint* other = holding_back(model, moving_with(model, carrying, joint.child), to.joint))
    return name + " is in a loop, which " + quoted(other->name) + " closes: it cannot be set";
  if (!is_in_range(to.position, -kMaxMagnitude, kMaxMagnitude) ||
      !is_in_range(to.velocity, -kMaxMagnitude, kMaxMagnitude))
    return name + " was given a number that is not finite or beyond 1e6";
  if (joint.limited && !is_in_range(to.position, joint.lower, joint.upper))
    return name + " goes from " + std::to_string(joint.lower) + " to " + std::to_string(joint.upper) +
           ", not to " + std::to_string(to.position);
  return "";
}

void place_body(const WorldModel& model, BodyId body, const Placement& to, WorldState& state) {
  carry_along(model, moving_with(model, carrying_joints(model), body), body, to, state);
  measure_joints(model, state);
}

void place_joints(const WorldModel& model, std::span<const JointPlacement> to, WorldState& state) {
  std::vector<JointPlacement> ordered(to.begin(), to.end());  // parents before children
  std::ranges::sort(ordered, {}, &JointPlacement::joint);
  const auto carrying = carrying_joints(model);
  for (const JointPlacement& set : ordered) {
    const Joint& joint = model.joints[set.joint.index()];
    const Placement child = hung_on(model, state, joint, set.position, set.velocity);
    carry_along(model, moving_with(model, carrying, joint.child), joint.child, child, state);
    state.joints[set.joint.index()].position = set.position;  // the turn that is meant
  }
  measure_joints(model, state);
}

KinematicTree kinematic_tree(const WorldModel& model) {
  KinematicTree tree;
  const auto carrying = carrying_joints(model);
  for (std::size_t i = 0; i < model.bodies.size(); ++i)
    if (model.bodies[i].kinematic && !carrying[i].valid())
      tree.roots.push_back({static_cast<std::int32_t>(i)});
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const BodyId child = model.joints[i].child;
    if (model.bodies[child.index()].kinematic && carrying[child.index()].index() == i)
      tree.joints.push_back({static_cast<std::int32_t>(i)});
  }
  return tree;
}

void move_kinematic(const WorldModel& model, const KinematicTree& tree, double tick_s,
                    const WorldState& before, WorldState& state) {
  for (const BodyId root : tree.roots)
    move_root(tick_s, before.bodies[root.index()], state.bodies[root.index()]);
  for (const JointId id : tree.joints) {
    const Joint& joint = model.joints[id.index()];
    const std::size_t child = joint.child.index();
    if (!is_drivable(joint.kind)) {
      Placement parent;
      Pose X_PB = placement_of(model.bodies[child], before.bodies[child]).X_WB;
      if (joint.parent.valid()) {
        const Body& body = model.bodies[joint.parent.index()];
        X_PB = link_pose(body, before.bodies[joint.parent.index()]).inverse() * X_PB;
        parent = placement_of(body, state.bodies[joint.parent.index()]);
      }
      Placement now{parent.X_WB * X_PB, parent.v_WB, parent.w_WB};
      now.v_WB += parent.w_WB.cross(now.X_WB.p - parent.X_WB.p);
      state.bodies[child] = state_of(model.bodies[child], now);
      continue;
    }
    const JointState& motion = before.joints[id.index()];
    double position = motion.position + tick_s * motion.velocity, velocity = motion.velocity;
    if (joint.limited && !is_in_range(position, joint.lower, joint.upper)) {
      position = std::clamp(position, joint.lower, joint.upper);
      velocity = 0.0;
    }
    state.bodies[child] = state_of(model.bodies[child], hung_on(model, state, joint, position, velocity));
  }
}

}  // namespace visum::world

#include "server/dynamics/plugged/plain_world.h"

#include <algorithm>
#include <cmath>

#include "server/world/joint_kinds.h"

namespace visum::dynamics::plugged {
namespace {

// Conversions between our types and the plug-ins' plain values.
void put(const Eigen::Vector3d& from, double to[3]) {
  std::copy_n(from.data(), 3, to);
}

Eigen::Vector3d vector_of(const double from[3]) {
  return {from[0], from[1], from[2]};
}

plugin::Pose plain(const world::Pose& pose) {
  plugin::Pose to{};
  put(pose.p, to.p);
  to.q_wxyz[0] = pose.q.w();
  put(pose.q.vec(), to.q_wxyz + 1);
  return to;
}

plugin::EngineBody plain(const world::Body& body, bool own) {
  plugin::EngineBody to{body.name, own};
  // The engine learns only the motion of bodies that another engine moves.
  if (!own) return to;
  to.mass_kg = body.mass_kg;
  for (int i = 0; i < 9; ++i) to.inertia[i] = body.inertia_C(i / 3, i % 3);
  return to;
}

plugin::Motion plain(const world::BodyState& body) {
  plugin::Motion to{};
  put(body.p_WC, to.p);
  to.q_wxyz[0] = body.q_WB.w();
  put(body.q_WB.vec(), to.q_wxyz + 1);
  put(body.v_WC, to.velocity);
  put(body.w_WB, to.turn_rate);
  return to;
}

plugin::EngineContact plain(const collision::Contact& contact) {
  plugin::EngineContact to;
  to.a = contact.body_a.value;
  to.b = contact.body_b.value;
  put(contact.p_W, to.p);
  put(contact.normal_W, to.normal);
  to.depth = contact.depth;
  to.friction = contact.friction;
  to.restitution = contact.restitution;
  to.rolling_friction = contact.rolling_friction;
  to.torsional_friction = contact.torsional_friction;
  return to;
}

plugin::JointDrive plain(const hwparts::JointDrive& drive) {
  return {drive.target_velocity, drive.compliance, drive.max_effort, drive.feedforward};
}

}  // namespace

PlainWorld::PlainWorld(const world::WorldModel& model, std::int32_t engine_index)
    : tick_s(static_cast<double>(model.tick_ns) * 1e-9), model_(model) {
  for (const world::Body& body : model.bodies)
    bodies.push_back(plain(body, !body.fixed && body.engine == engine_index));
  for (std::size_t i = 0; i < model.joints.size(); ++i)
    if (owns(model.joints[i].child)) add_joint(model.joints[i], {static_cast<std::int32_t>(i)});
  // Joints belong to the engine that moves their child. All lists get their size here, so ticks need not
  // allocate.
  samples_.resize(joints.size());
  drives_.resize(joints.size());
  efforts_.resize(joints.size());
  motions_.resize(bodies.size());
}

void PlainWorld::add_joint(const world::Joint& joint, world::JointId id) {
  const world::JointKindInfo& kind = world::info(joint.kind);
  if (joint.kind == world::JointKind::kPointOnCurve)
    throw plugin::Error("joint '" + joint.name + "' is of kind " + kind.name +
                        ", which engines of plug-ins do not support");
  // Plug-ins see joints from the centres of mass.
  const auto seen_from_center = [&](world::BodyId body, const world::Pose& X_BJ) {
    const Eigen::Vector3d p_BC =
        body.valid() ? model_.bodies[body.index()].p_BC : Eigen::Vector3d(Eigen::Vector3d::Zero());
    return plain(world::Pose{X_BJ.p - p_BC, X_BJ.q});
  };
  plugin::EngineJoint to{joint.name, kind.name};
  to.parent = joint.parent.valid() ? joint.parent.value : -1;
  to.child = joint.child.value;
  to.in_parent = seen_from_center(joint.parent, joint.X_PJ);
  to.in_child = seen_from_center(joint.child, joint.X_CJ);
  put(joint.axis_J, to.axis);
  put(joint.axis2_J, to.axis2);
  to.pitch_m = joint.pitch_m;
  to.stiffness = joint.stiffness;
  to.rest = joint.rest;
  to.limited = joint.limited;
  to.lower = joint.lower;
  to.upper = joint.upper;
  to.stop_restitution = joint.stop_restitution;
  to.friction = joint.friction;
  to.damping = joint.damping;
  joints.push_back(to);
  joint_ids_.push_back(id);
}

void PlainWorld::load(const StepInput& input, const world::WorldState& state) {
  for (std::size_t i = 0; i < bodies.size(); ++i) motions_[i] = plain(state.bodies[i]);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const world::JointState& joint = state.joints[joint_ids_[i].index()];
    samples_[i] = {joint.position, joint.velocity, joint.effort};
    drives_[i] = plain(input.drives[joint_ids_[i].index()]);
  }
  // Pushes and contacts of this engine's bodies only, in the order of the world.
  std::ranges::fill(efforts_, 0.0);
  pushes_.clear();
  for (const Wrench& wrench : input.wrenches) {
    if (!owns(wrench.body)) continue;
    plugin::EnginePush& push = pushes_.emplace_back();
    push.body = wrench.body.value;
    put(wrench.force_n, push.force_n);
    put(wrench.torque_nm, push.torque_nm);
  }
  contacts_.clear();
  contact_ids_.clear();
  for (std::size_t i = 0; i < input.contacts.size(); ++i) {
    const collision::Contact& contact = input.contacts[i];
    if (!owns(contact.body_a) && !owns(contact.body_b)) continue;
    contacts_.push_back(plain(contact));
    contact_ids_.push_back(i);
  }
}

plugin::EngineTick PlainWorld::tick(double step_s) {
  plugin::EngineTick tick{step_s, {}, pushes_, drives_, samples_, contacts_, motions_, efforts_};
  put(model_.gravity, tick.gravity);
  return tick;
}

void PlainWorld::store(const StepInput& input, world::WorldState& state) const {
  for (std::size_t i = 0; i < joints.size(); ++i)
    if (!std::isfinite(efforts_[i]))
      throw plugin::Error("gives joint '" + joints[i].name + "' an effort that is no finite number");
  for (const plugin::EngineContact& contact : contacts_)
    if (!vector_of(contact.force_on_a).allFinite())
      throw plugin::Error("gives body '" + bodies[static_cast<std::size_t>(contact.a)].name +
                          "' a contact force that is no finite number");
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].own) continue;
    const plugin::Motion& motion = motions_[i];
    state.bodies[i] = {vector_of(motion.p),
                       {motion.q_wxyz[0], motion.q_wxyz[1], motion.q_wxyz[2], motion.q_wxyz[3]},
                       vector_of(motion.velocity),
                       vector_of(motion.turn_rate)};
  }
  for (std::size_t i = 0; i < joints.size(); ++i) state.joints[joint_ids_[i].index()].effort = efforts_[i];
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    collision::Contact& to = input.contacts[contact_ids_[i]];
    to.force_on_a_W = vector_of(contacts_[i].force_on_a);
    // A contact cannot pull.
    to.normal_force_n = std::max(0.0, to.normal_W.dot(to.force_on_a_W));
  }
}

}  // namespace visum::dynamics::plugged

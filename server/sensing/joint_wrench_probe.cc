// Kind `joint_wrench`. Engines do not say what their joints transmit, so it follows from the bodies that hang
// on the joint. Their momentum changes by gravity, by contacts, by pushes, and by the force F and torque T
// through the joint. All but F and T are known. Newton's and Euler's laws over the whole tick, about the
// joint's origin at the tick's end, give:
//     F = dp/dt - m g - F_contacts - F_pushes
//     T = dL/dt - r x m g - T_contacts - T_pushes
#include "server/sensing/probes.h"
#include "server/world/joint_kinds.h"

namespace visum::sensing {
namespace {

using Eigen::Vector3d;
using world::BodyId;

struct Wrench {
  Vector3d force = Vector3d::Zero(), torque = Vector3d::Zero();

  void add(const Vector3d& f, const Vector3d& arm) {
    force += f;
    torque += arm.cross(f);
  }
};

// The bodies that hang on the joint, by BodyId. Fails where they also hang on something else: the two loads
// could not be told apart.
std::vector<bool> hanging_on(const world::WorldModel& model, world::JointId cut, const config::Node& config) {
  const auto stands = [&](BodyId id) { return !id.valid() || model.bodies[id.index()].fixed; };
  std::vector<bool> hangs(model.bodies.size(), false);
  std::vector<BodyId> open{model.joints[cut.index()].child};
  hangs[open.front().index()] = true;
  while (!open.empty()) {
    const BodyId body = open.back();
    open.pop_back();
    for (std::size_t i = 0; i < model.joints.size(); ++i) {
      const world::Joint& joint = model.joints[i];
      if (i == cut.index() || (joint.parent != body && joint.child != body)) continue;
      const BodyId other = joint.parent == body ? joint.child : joint.parent;
      if (stands(other) || other == model.joints[cut.index()].parent)
        config.get("joint").fail("joint '" + joint.name +
                                 "' carries the load, too: only a joint that carries alone " +
                                 "can be measured");
      if (hangs[other.index()]) continue;
      hangs[other.index()] = true;
      open.push_back(other);
    }
  }
  return hangs;
}

class JointWrenchProbe : public Probe {
 public:
  JointWrenchProbe(const world::Joint& joint, std::vector<bool> hangs)
      : joint_(joint), hangs_(std::move(hangs)) {}

  void measure(const Moment& moment, std::span<double> truth) override {
    const std::size_t child = joint_.child.index();
    const world::Pose X_WJ =
        world::link_pose(moment.model.bodies[child], moment.now.bodies[child]) * joint_.X_CJ;
    Wrench through;
    for (std::size_t i = 0; i < hangs_.size(); ++i)
      if (hangs_[i]) add_motion(moment, i, X_WJ.p, through);
    for (const auto& contact : moment.contacts) {
      const bool a = hangs_[contact.body_a.index()], b = hangs_[contact.body_b.index()];
      if (a == b) continue;
      through.add(a ? -contact.force_on_a_W : contact.force_on_a_W, contact.p_W - X_WJ.p);
      through.torque += a ? -contact.torque_on_a_W : contact.torque_on_a_W;
    }
    for (const auto& push : moment.pushes) {
      if (!hangs_[push.body.index()]) continue;
      through.add(-push.force_n, moment.now.bodies[push.body.index()].p_WC - X_WJ.p);
      through.torque -= push.torque_nm;
    }
    const auto to_J = X_WJ.q.conjugate();
    const Vector3d force_J = to_J * through.force, torque_J = to_J * through.torque;
    for (int axis = 0; axis < 3; ++axis) {
      truth[static_cast<std::size_t>(axis)] = force_J[axis];
      truth[static_cast<std::size_t>(axis + 3)] = torque_J[axis];
    }
  }

 private:
  // Adds the force and torque that move body i as it moved in the tick, without its weight.
  static void add_motion(const Moment& moment, std::size_t i, const Vector3d& about, Wrench& through) {
    const world::Body& body = moment.model.bodies[i];
    const world::BodyState &before = moment.before.bodies[i], &now = moment.now.bodies[i];
    const auto spin = [&](const world::BodyState& state) {
      const Vector3d w_B = state.q_WB.conjugate() * state.w_WB;
      return Vector3d(state.q_WB * Vector3d(body.inertia_C * w_B));
    };
    const Vector3d acceleration = (now.v_WC - before.v_WC) / moment.tick_s;
    const Vector3d middle = 0.5 * (now.p_WC + before.p_WC);
    through.add(body.mass_kg * (acceleration - moment.model.gravity), middle - about);
    through.torque += (spin(now) - spin(before)) / moment.tick_s;
  }

  const world::Joint& joint_;
  std::vector<bool> hangs_;
};

}  // namespace

std::unique_ptr<Probe> make_joint_wrench_probe(const ProbeContext& context) {
  const auto& model = context.scene.world;
  const world::JointId id = context.mount.joint;
  if (!id.valid()) context.config.fail("a joint_wrench sensor needs 'joint'");
  const world::Joint& joint = model.joints[id.index()];
  if (!world::info(joint.kind).holds_anything)
    context.config.get("joint").fail("joint '" + joint.name +
                                     "' holds nothing: there is no force to measure");
  return std::make_unique<JointWrenchProbe>(joint, hanging_on(model, id, context.config));
}

}  // namespace visum::sensing

// ODE's dWorldStep as a program without Visum would call it. The difference to `ode` is the cost of our seam.
#include <ode/ode.h>

#include "tests/bench/peers/peers.h"

namespace visum::bench {
namespace {

class BareOde : public Stepper {
 public:
  explicit BareOde(const world::WorldModel& model)
      : start_(initial_state(model)),
        tick_s_(1e-9 * static_cast<double>(model.tick_ns)),
        world_(dWorldCreate()) {
    dWorldSetGravity(world_, model.gravity.x(), model.gravity.y(), model.gravity.z());
    for (const auto& body : model.bodies) add_body(body);
    reset();
    for (const auto& joint : model.joints) add_hinge(model, joint);
  }
  ~BareOde() override { dWorldDestroy(world_); }
  BareOde(const BareOde&) = delete;
  BareOde& operator=(const BareOde&) = delete;

  void reset() override {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const auto& motion = start_.bodies[i];
      const dQuaternion q = {motion.q_WB.w(), motion.q_WB.x(), motion.q_WB.y(), motion.q_WB.z()};
      dBodySetPosition(bodies_[i], motion.p_WC.x(), motion.p_WC.y(), motion.p_WC.z());
      dBodySetQuaternion(bodies_[i], q);
      dBodySetLinearVel(bodies_[i], motion.v_WC.x(), motion.v_WC.y(), motion.v_WC.z());
      dBodySetAngularVel(bodies_[i], motion.w_WB.x(), motion.w_WB.y(), motion.w_WB.z());
    }
  }
  void step() override { dWorldStep(world_, tick_s_); }
  void store(world::WorldState& state) const override {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      const dReal* q = dBodyGetQuaternion(bodies_[i]);
      const auto vector = [](const dReal* from) { return Eigen::Vector3d(from[0], from[1], from[2]); };
      state.bodies[i] = {vector(dBodyGetPosition(bodies_[i])), Eigen::Quaterniond(q[0], q[1], q[2], q[3]),
                         vector(dBodyGetLinearVel(bodies_[i])), vector(dBodyGetAngularVel(bodies_[i]))};
    }
  }

 private:
  void add_body(const world::Body& body) {
    const Eigen::Matrix3d& j = body.inertia_C;
    dMass mass;
    dMassSetParameters(&mass, body.mass_kg, 0, 0, 0, j(0, 0), j(1, 1), j(2, 2), j(0, 1), j(0, 2), j(1, 2));
    bodies_.push_back(dBodyCreate(world_));
    dBodySetMass(bodies_.back(), &mass);
  }

  void add_hinge(const world::WorldModel& model, const world::Joint& joint) {
    const world::Pose X_WJ =
        link_pose(model.bodies[joint.child.index()], start_.bodies[joint.child.index()]) * joint.X_CJ;
    const Eigen::Vector3d axis = X_WJ.q * joint.axis_J;
    const dJointID hinge = dJointCreateHinge(world_, nullptr);
    dJointAttach(hinge, bodies_[joint.child.index()],
                 joint.parent.valid() ? bodies_[joint.parent.index()] : nullptr);
    dJointSetHingeAnchor(hinge, X_WJ.p.x(), X_WJ.p.y(), X_WJ.p.z());
    dJointSetHingeAxis(hinge, axis.x(), axis.y(), axis.z());
  }

  const world::WorldState start_;
  const double tick_s_;
  dWorldID world_;
  std::vector<dBodyID> bodies_;
};

std::unique_ptr<Stepper> make(const world::WorldModel& model, const std::string&) {
  return std::make_unique<BareOde>(model);
}

}  // namespace

void add_bare_ode(std::vector<StepperKind>& kinds) {
  kinds.push_back({"ode-bare", is_mechanism, make});
}

}  // namespace visum::bench

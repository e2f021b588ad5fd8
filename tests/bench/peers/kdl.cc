// Orocos KDL has forward dynamics but no integrator; here it gets a semi-implicit Euler.
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/chainfksolvervel_recursive.hpp>
#include <stdexcept>

#include "tests/bench/peers/peers.h"

namespace visum::bench {
namespace {

KDL::Vector kdl(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Eigen::Vector3d eigen(const KDL::Vector& v) {
  return {v.x(), v.y(), v.z()};
}

KDL::Chain chain_of(const world::WorldModel& model) {
  KDL::Chain chain;
  for (const auto& joint : model.joints) {
    const auto& body = model.bodies[joint.child.index()];
    const Eigen::Matrix3d& j = body.inertia_C;
    chain.addSegment(KDL::Segment(
        body.name, KDL::Joint(joint.name, kdl(joint.X_PJ.p), kdl(joint.axis_J), KDL::Joint::RotAxis),
        KDL::Frame(kdl(joint.X_PJ.p)),
        KDL::RigidBodyInertia(body.mass_kg, kdl(body.p_BC),
                              KDL::RotationalInertia(j(0, 0), j(1, 1), j(2, 2), j(0, 1), j(0, 2), j(1, 2)))));
  }
  return chain;
}

class Kdl : public Stepper {
 public:
  explicit Kdl(const world::WorldModel& model)
      : model_(model),
        tick_s_(1e-9 * static_cast<double>(model.tick_ns)),
        chain_(chain_of(model)),
        solver_(chain_, kdl(model.gravity)),
        position_(chain_.getNrOfJoints()),
        velocity_(position_),
        acceleration_(position_),
        torque_(position_),
        forces_(chain_.getNrOfSegments(), KDL::Wrench::Zero()) {
    reset();
  }

  void reset() override {
    for (std::size_t i = 0; i < model_.joints.size(); ++i)
      position_(static_cast<unsigned>(i)) = model_.joints[i].initial_position;
    velocity_.data.setZero();
  }

  void step() override {
    if (solver_.CartToJnt(position_, velocity_, torque_, forces_, acceleration_) < 0)
      throw std::runtime_error("KDL's forward dynamics failed");
    velocity_.data += tick_s_ * acceleration_.data;
    position_.data += tick_s_ * velocity_.data;
  }

  void store(world::WorldState& state) const override {
    KDL::ChainFkSolverVel_recursive kinematics(chain_);
    const KDL::JntArrayVel joints(position_, velocity_);
    for (std::size_t i = 0; i < model_.joints.size(); ++i) {
      KDL::FrameVel frame;
      kinematics.JntToCart(joints, frame, static_cast<int>(i) + 1);
      auto& motion = state.bodies[model_.joints[i].child.index()];
      double x, y, z, w;
      frame.M.R.GetQuaternion(x, y, z, w);
      motion.q_WB = Eigen::Quaterniond(w, x, y, z);
      const Eigen::Vector3d arm = motion.q_WB * model_.bodies[model_.joints[i].child.index()].p_BC;
      motion.w_WB = eigen(frame.M.w);
      motion.p_WC = eigen(frame.p.p) + arm;
      motion.v_WC = eigen(frame.p.v) + motion.w_WB.cross(arm);
    }
  }

 private:
  const world::WorldModel model_;
  const double tick_s_;
  const KDL::Chain chain_;
  KDL::ChainFdSolver_RNE solver_;
  KDL::JntArray position_, velocity_, acceleration_, torque_;
  KDL::Wrenches forces_;
};

std::unique_ptr<Stepper> make(const world::WorldModel& model, const std::string&) {
  return std::make_unique<Kdl>(model);
}

// Its solver inverts the mass matrix, so the cost is cubic in the number of links.
bool takes(const world::WorldModel& model) {
  return is_open_chain(model) && model.joints.size() <= 64;
}

}  // namespace

void add_kdl(std::vector<StepperKind>& kinds) {
  kinds.push_back({"kdl", takes, make});
}

}  // namespace visum::bench

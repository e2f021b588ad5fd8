// Bullet in double precision: btMultiBody for open chains, rigid bodies (bullet_bodies.h) where there are
// shapes.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <btBulletDynamicsCommon.h>

#include "tests/bench/peers/bullet_bodies.h"
#include "tests/bench/peers/bullet_types.h"
#include "tests/bench/peers/peers.h"

namespace visum::bench {
namespace {

// Everything that a Bullet world needs. It must outlive the bodies in it.
struct BulletWorld {
  explicit BulletWorld(const world::WorldModel& model) : tick_s(1e-9 * static_cast<double>(model.tick_ns)) {
    world.setGravity(bt(model.gravity));
  }
  void step() { world.stepSimulation(tick_s, 0); }

  const double tick_s;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btMultiBodyConstraintSolver solver;
  btMultiBodyDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
};

// Links as Bullet wants them: with frames at their centres of mass.
class BulletChain : public Stepper {
 public:
  explicit BulletChain(const world::WorldModel& model)
      : model_(model),
        bullet_(model),
        chain_(static_cast<int>(model.joints.size()), 0.0, btVector3(0, 0, 0), true, false) {
    for (int i = 0; i < chain_.getNumLinks(); ++i) add(i);
    chain_.finalizeMultiDof();
    chain_.setLinearDamping(0.0);
    chain_.setAngularDamping(0.0);
    chain_.setMaxCoordinateVelocity(1e6);
    bullet_.world.addMultiBody(&chain_);
    reset();
  }
  ~BulletChain() override { bullet_.world.removeMultiBody(&chain_); }
  BulletChain(const BulletChain&) = delete;
  BulletChain& operator=(const BulletChain&) = delete;

  void reset() override {
    for (int i = 0; i < chain_.getNumLinks(); ++i) {
      chain_.setJointPos(i, model_.joints[static_cast<std::size_t>(i)].initial_position);
      chain_.setJointVel(i, 0.0);
    }
    chain_.clearForcesAndTorques();
    chain_.clearVelocities();
  }
  void step() override { bullet_.step(); }
  void store(world::WorldState& state) const override {
    btAlignedObjectArray<btQuaternion> rotations;
    btAlignedObjectArray<btVector3> origins;
    chain_.forwardKinematics(rotations, origins);
    std::vector<btVector3> turning(model_.bodies.size() + 1), moving(model_.bodies.size() + 1);
    chain_.compTreeLinkVelocities(turning.data(), moving.data());
    for (std::size_t i = 0; i < model_.bodies.size(); ++i) {
      const btTransform& X = chain_.getLink(static_cast<int>(i)).m_cachedWorldTransform;
      state.bodies[i] = {eigen(X.getOrigin()), eigen(X.getRotation()), eigen(X.getBasis() * moving[i + 1]),
                         eigen(X.getBasis() * turning[i + 1])};
    }
  }

 private:
  void add(int index) {
    const auto& joint = model_.joints[static_cast<std::size_t>(index)];
    const auto& body = model_.bodies[static_cast<std::size_t>(index)];
    const Eigen::Vector3d parent_com =
        joint.parent.valid() ? model_.bodies[joint.parent.index()].p_BC : Eigen::Vector3d::Zero();
    chain_.setupRevolute(index, body.mass_kg, bt(Eigen::Vector3d(body.inertia_C.diagonal())),
                         joint.parent.value, btQuaternion::getIdentity(), bt(joint.axis_J),
                         bt(joint.X_PJ.p - parent_com), bt(body.p_BC), true);
  }

  const world::WorldModel model_;
  BulletWorld bullet_;
  mutable btMultiBody chain_;  // its kinematics are computed on demand
};

bool takes(const world::WorldModel& model) {
  return is_open_chain(model) || is_bullet_scene(model);
}

std::unique_ptr<Stepper> make(const world::WorldModel& model, const std::string&) {
  if (model.shapes.empty()) return std::make_unique<BulletChain>(model);
  return make_bullet_bodies(model);
}

}  // namespace

void add_bullet(std::vector<StepperKind>& kinds) {
  kinds.push_back({"bullet", takes, make});
}

}  // namespace visum::bench

#include <stdexcept>

#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/DegreeOfFreedom.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/simulation/World.hpp>

#include "tests/bench/peers/peers.h"

namespace visum::bench {
namespace {

Eigen::Isometry3d isometry(const world::Pose& X) {
  Eigen::Isometry3d result = Eigen::Isometry3d::Identity();
  result.linear() = X.q.toRotationMatrix();
  result.translation() = X.p;
  return result;
}

class Dart : public Stepper {
 public:
  explicit Dart(const world::WorldModel& model)
      : model_(model), skeleton_(dart::dynamics::Skeleton::create("mechanism")), nodes_(model.bodies.size()) {
    for (const auto& joint : model.joints) add(joint);
    world_->setTimeStep(1e-9 * static_cast<double>(model.tick_ns));
    world_->setGravity(model.gravity);
    world_->addSkeleton(skeleton_);
    reset();
  }

  void reset() override {
    for (std::size_t i = 0; i < model_.joints.size(); ++i)
      skeleton_->getDof(i)->setPosition(model_.joints[i].initial_position);
    skeleton_->resetVelocities();
  }
  // Debian's DART is built with its assertions: a swing that explodes would end the program in a later step.
  void step() override {
    world_->step();
    constexpr double kFastest_rad_s = 1e3;
    if (!(skeleton_->getVelocities().cwiseAbs().maxCoeff() < kFastest_rad_s))
      throw std::runtime_error("exploded at this step");
  }
  void store(world::WorldState& state) const override {
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      state.bodies[i] = {nodes_[i]->getCOM(), Eigen::Quaterniond(nodes_[i]->getWorldTransform().linear()),
                         nodes_[i]->getCOMLinearVelocity(), nodes_[i]->getAngularVelocity()};
  }

 private:
  void add(const world::Joint& joint) {
    dart::dynamics::RevoluteJoint::Properties settings;
    settings.mName = joint.name;
    settings.mAxis = joint.axis_J;
    settings.mT_ParentBodyToJoint = isometry(joint.X_PJ);
    settings.mT_ChildBodyToJoint = isometry(joint.X_CJ);
    auto* parent = joint.parent.valid() ? nodes_[joint.parent.index()] : nullptr;
    const auto& body = model_.bodies[joint.child.index()];
    auto* node = skeleton_
                     ->createJointAndBodyNodePair<dart::dynamics::RevoluteJoint>(
                         parent, settings, dart::dynamics::BodyNode::AspectProperties(body.name))
                     .second;
    node->setInertia(dart::dynamics::Inertia(body.mass_kg, body.p_BC, body.inertia_C));
    nodes_[joint.child.index()] = node;
  }

  const world::WorldModel model_;
  dart::simulation::WorldPtr world_ = dart::simulation::World::create();
  dart::dynamics::SkeletonPtr skeleton_;
  std::vector<dart::dynamics::BodyNode*> nodes_;
};

std::unique_ptr<Stepper> make(const world::WorldModel& model, const std::string&) {
  return std::make_unique<Dart>(model);
}

}  // namespace

void add_dart(std::vector<StepperKind>& kinds) {
  kinds.push_back({"dart", is_open_chain, make});
}

}  // namespace visum::bench

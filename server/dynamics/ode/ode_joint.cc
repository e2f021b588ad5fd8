#include "server/dynamics/ode/ode_joint.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "server/dynamics/ode/ode_stops.h"
#include "server/world/joint_kinds.h"

namespace visum::dynamics::ode {
namespace {

constexpr int kDriveRow = 0;
constexpr int kDampingRow = 1;

bool says_nothing(const hwparts::JointDrive& drive) {
  return drive.max_effort == 0.0 && drive.feedforward == 0.0;
}

bool is_ground(const world::WorldModel& model, world::BodyId id) {
  return !id.valid() || model.bodies[id.index()].fixed;
}

// Where the joint's frame is while the joint is made. A parent that does not move says where; otherwise the
// frame is W itself, which keeps the numbers clean.
world::Pose joint_frame(const world::WorldModel& model, const world::Joint& joint) {
  if (!is_ground(model, joint.parent)) return {};
  return joint.parent.valid() ? model.bodies[joint.parent.index()].X_WB * joint.X_PJ : joint.X_PJ;
}

}  // namespace

OdeJoint::OdeJoint(OdeWorld& world, const world::WorldModel& model, world::JointId id)
    : model_(model.joints[id.index()]),
      setting_(model.engines[static_cast<std::size_t>(model.bodies[model_.child.index()].engine)]),
      id_(id) {
  const world::Pose X_WJ = joint_frame(model, model_);
  if (!is_ground(model, model_.parent)) world.place_link(model_.parent, X_WJ * model_.X_PJ.inverse());
  world.place_link(model_.child, X_WJ * model_.X_CJ.inverse());
  joint_ = make_joint(world);
  // The child is ODE's first body, so that positive is the child's motion against the parent.
  dJointAttach(joint_, world.body(model_.child), world.body(model_.parent));
  place_joint(X_WJ);
  if (!world::is_drivable(model_.kind)) return;
  prepare_stops(joint_, model_, setting_);
  make_motor(world, X_WJ.q * model_.axis_J);
}

// Throws std::runtime_error for kinds that ODE does not have.
dJointID OdeJoint::make_joint(OdeWorld& world) const {
  switch (model_.kind) {
    case world::JointKind::kFixed:
      return dJointCreateFixed(world.id(), nullptr);
    case world::JointKind::kHinge:
      return dJointCreateHinge(world.id(), nullptr);
    case world::JointKind::kSlider:
      return dJointCreateSlider(world.id(), nullptr);
    case world::JointKind::kBall:
      return dJointCreateBall(world.id(), nullptr);
    case world::JointKind::kUniversal:
      return dJointCreateUniversal(world.id(), nullptr);
    default:
      throw std::runtime_error("joint '" + model_.name + "' is of type " + world::info(model_.kind).name +
                               ", which engine 'ode' does not have; use engine 'impulse'");
  }
}

void OdeJoint::place_joint(const world::Pose& X_WJ) const {
  const Eigen::Vector3d& p = X_WJ.p;
  const Eigen::Vector3d axis = X_WJ.q * model_.axis_J, axis2 = X_WJ.q * model_.axis2_J;
  switch (model_.kind) {
    case world::JointKind::kHinge:
      dJointSetHingeAnchor(joint_, p.x(), p.y(), p.z());
      dJointSetHingeAxis(joint_, axis.x(), axis.y(), axis.z());
      return;
    case world::JointKind::kSlider:
      dJointSetSliderAxis(joint_, axis.x(), axis.y(), axis.z());
      return;
    case world::JointKind::kBall:
      dJointSetBallAnchor(joint_, p.x(), p.y(), p.z());
      return;
    case world::JointKind::kUniversal:
      // ODE's first axis belongs to its first body, the child.
      dJointSetUniversalAnchor(joint_, p.x(), p.y(), p.z());
      dJointSetUniversalAxis1(joint_, axis2.x(), axis2.y(), axis2.z());
      dJointSetUniversalAxis2(joint_, axis.x(), axis.y(), axis.z());
      return;
    default:
      dJointSetFixed(joint_);
  }
}

// Two rows along the joint's axis, turning with the child. Feedback tells what they transmit.
void OdeJoint::make_motor(OdeWorld& world, const Eigen::Vector3d& axis_W) {
  const bool hinge = model_.kind == world::JointKind::kHinge;
  motor_ = hinge ? dJointCreateAMotor(world.id(), nullptr) : dJointCreateLMotor(world.id(), nullptr);
  dJointAttach(motor_, world.body(model_.child), world.body(model_.parent));
  const auto set_axis = hinge ? dJointSetAMotorAxis : dJointSetLMotorAxis;
  (hinge ? dJointSetAMotorNumAxes : dJointSetLMotorNumAxes)(motor_, 2);
  constexpr int kWithChild = 1;
  for (const int row : {kDriveRow, kDampingRow})
    set_axis(motor_, row, kWithChild, axis_W.x(), axis_W.y(), axis_W.z());
  feedback_ = std::make_unique<dJointFeedback>();
  dJointSetFeedback(motor_, feedback_.get());
}

void OdeJoint::set_row(int row, double velocity, double compliance, double max_effort) {
  const auto set = model_.kind == world::JointKind::kHinge ? dJointSetAMotorParam : dJointSetLMotorParam;
  const int group = row * dParamGroup;
  set(motor_, group + dParamVel, velocity);
  // Never harder than the other joints: without any softness, ODE's solver may find no solution.
  set(motor_, group + dParamCFM, std::max(compliance, setting_.cfm));
  set(motor_, group + dParamFMax, max_effort);
}

void OdeJoint::add_effort(double effort) {
  if (effort == 0.0) return;
  if (model_.kind == world::JointKind::kHinge)
    dJointAddHingeTorque(joint_, effort);
  else
    dJointAddSliderForce(joint_, effort);
}

void OdeJoint::apply(const hwparts::JointDrive& drive, const world::WorldState& state) {
  if (motor_ == nullptr) return;
  set_stops(joint_, model_, state.joints[id_.index()].position);
  // A drive takes the place of the model's friction and damping.
  const bool driven = !says_nothing(drive);
  const double damping = driven ? 0.0 : model_.damping;
  if (driven)
    set_row(kDriveRow, drive.target_velocity, drive.compliance, drive.max_effort);
  else
    set_row(kDriveRow, 0.0, 0.0, model_.friction);
  set_row(kDampingRow, 0.0, damping > 0.0 ? 1.0 / damping : 0.0, damping > 0.0 ? dInfinity : 0.0);
  feedforward_ = drive.feedforward;
  add_effort(feedforward_);
  axis_W_ = state.bodies[model_.child.index()].q_WB * (model_.X_CJ.q * model_.axis_J);
  *feedback_ = {};  // ODE writes it only for rows that exist
}

double OdeJoint::effort() const {
  if (motor_ == nullptr) return 0.0;
  // The feedback is a vector on the child; its share along the axis is the effort.
  const dReal* transmitted = model_.kind == world::JointKind::kHinge ? feedback_->t1 : feedback_->f1;
  return Eigen::Map<const Eigen::Vector3d>(transmitted).dot(axis_W_) + feedforward_;
}

}  // namespace visum::dynamics::ode

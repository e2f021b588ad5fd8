#include "clients/examples/pick_and_place/urdf_chain.h"

#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace visum::pick_and_place {
namespace {

Eigen::Vector3d to_vector(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

Eigen::Isometry3d to_isometry(const urdf::Pose& pose) {
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();
  const urdf::Rotation& r = pose.rotation;
  X.linear() = Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix();
  X.translation() = to_vector(pose.position);
  return X;
}

urdf::ModelInterfaceSharedPtr parse(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error(file + ": cannot be read");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  if (!model) throw std::runtime_error(file + ": is no URDF");
  return model;
}

// In the order of their names, as urdfdom keeps them.
std::vector<urdf::JointSharedPtr> finger_joints(const urdf::ModelInterface& model, const std::string& file) {
  std::vector<urdf::JointSharedPtr> fingers;
  for (const auto& [name, joint] : model.joints_) {
    if (joint->type == urdf::Joint::PRISMATIC) fingers.push_back(joint);
  }
  if (fingers.empty()) throw std::runtime_error(file + ": has no fingers (prismatic joints)");
  for (const auto& finger : fingers) {
    if (finger->parent_link_name != fingers[0]->parent_link_name) {
      throw std::runtime_error(file + ": fingers " + fingers[0]->name + " and " + finger->name +
                               " do not slide on one link");
    }
    if (!finger->limits) throw std::runtime_error(file + ": finger " + finger->name + " has no limits");
  }
  return fingers;
}

// The tool's frame on the palm.
Eigen::Isometry3d tool_on_palm(const std::vector<urdf::JointSharedPtr>& fingers, const std::string& file) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const auto& finger : fingers) {
    center += to_vector(finger->parent_to_joint_origin_transform.position) / double(fingers.size());
  }
  const Eigen::Isometry3d X_PF = to_isometry(fingers[0]->parent_to_joint_origin_transform);
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d opens = X_PF.linear() * to_vector(fingers[0]->axis);
  const Eigen::Vector3d y = opens - z * z.dot(opens);
  if (y.norm() < 0.5) throw std::runtime_error(file + ": the fingers do not move across the palm's z");
  Eigen::Isometry3d X_PT = Eigen::Isometry3d::Identity();
  X_PT.linear().col(1) = y.normalized();
  X_PT.linear().col(2) = z;
  X_PT.linear().col(0) = X_PT.linear().col(1).cross(z);
  X_PT.translation() = center;
  return X_PT;
}

double reach_of(const urdf::Link& finger) {
  double reach = 0.0;
  for (const auto& collision : finger.collision_array) {
    const auto* box = dynamic_cast<const urdf::Box*>(collision->geometry.get());
    if (box != nullptr) reach = std::max(reach, collision->origin.position.z + box->dim.z / 2.0);
  }
  return reach;
}

ChainJoint to_chain_joint(const urdf::Joint& joint, const Eigen::Isometry3d& X_PJ, const std::string& file) {
  const bool continuous = joint.type == urdf::Joint::CONTINUOUS;
  if (joint.type != urdf::Joint::REVOLUTE && !continuous) {
    throw std::runtime_error(file + ": joint " + joint.name + " neither turns nor is fixed");
  }
  if (!joint.limits || joint.limits->velocity <= 0.0) {
    throw std::runtime_error(file + ": joint " + joint.name + " has no maximum speed");
  }
  const double turns = 4.0 * std::numbers::pi;
  return {joint.name,
          X_PJ,
          to_vector(joint.axis).normalized(),
          continuous ? -turns : joint.limits->lower,
          continuous ? turns : joint.limits->upper,
          joint.limits->velocity};
}

Chain chain_to(const urdf::ModelInterface& model, const std::string& palm, const Eigen::Isometry3d& X_PT,
               const std::string& file) {
  Chain chain;
  chain.X_LT = X_PT;
  std::vector<urdf::JointSharedPtr> path;
  for (auto link = model.getLink(palm); link->parent_joint; link = link->getParent()) {
    path.push_back(link->parent_joint);
  }
  Eigen::Isometry3d X = Eigen::Isometry3d::Identity();  // from the last turning joint
  for (auto joint = path.rbegin(); joint != path.rend(); ++joint) {
    X = X * to_isometry((*joint)->parent_to_joint_origin_transform);
    if ((*joint)->type == urdf::Joint::FIXED) continue;
    chain.joints.push_back(to_chain_joint(**joint, X, file));
    X.setIdentity();
  }
  if (chain.joints.empty())
    throw std::runtime_error(file + ": no joint turns between the base and the gripper");
  chain.X_LT = X * X_PT;
  return chain;
}

}  // namespace

ArmModel read_arm(const std::string& urdf_file) {
  const urdf::ModelInterfaceSharedPtr model = parse(urdf_file);
  const auto fingers = finger_joints(*model, urdf_file);
  ArmModel arm;
  arm.chain = chain_to(*model, fingers[0]->parent_link_name, tool_on_palm(fingers, urdf_file), urdf_file);
  for (const auto& finger : fingers) {
    arm.fingers.push_back(
        {finger->name, finger->limits->lower, finger->limits->upper, finger->limits->velocity});
    arm.tip_reach_m = std::max(arm.tip_reach_m, reach_of(*model->getLink(finger->child_link_name)));
  }
  return arm;
}

}  // namespace visum::pick_and_place

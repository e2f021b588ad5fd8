#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "server/scene/convert/x3d_motors.h"
#include "server/scene/convert/x3d_scene.h"
#include "server/scene/convert/x3d_scenery.h"
#include "server/scene/convert/x3d_shapes.h"
#include "server/scene/convert/x3d_text.h"
#include "server/scene/draft.h"
#include "server/scene/joints.h"
#include "server/scene/parts.h"
#include "server/scene/settings.h"
#include "server/scene/values.h"

namespace visum::scene {
namespace {

using config::Node;
using world::JointKind;
using world::Pose;

constexpr double kSame = 1e-6;  // m, rad: metadata agrees with the fields beside it up to here

class Importer {
 public:
  Importer(const X3dNode& root, const std::filesystem::path& file)
      : root_(root), file_(file.string()), draft_(scene_), shapes_(draft_, root, file_) {
    scene_.file = file;
    scene_.name = file.stem().string();
    scene_.world.engines.push_back({"impulse"});
    scene_.engine_places.push_back({file_, 0, "engine"});
    scene_.world.surfaces.push_back({"default"});
    index(root);
  }

  Scene read() {
    scene_.world.gravity = {0, -9.81, 0};  // in X3D, y is up
    for (const X3dNode* collection : collections_) read_settings(*collection);
    for (const X3dNode* collection : collections_)
      for (const auto& [field, child] : collection->children)
        if (field == "bodies") read_body(resolved(child));
    for (const X3dNode* collection : collections_)
      for (const auto& [field, child] : collection->children)
        if (field == "joints") read_joint(resolved(child));
    for (const X3dNode* collection : collections_) read_rest(*collection);
    const std::size_t robots = read_x3d_scenery(draft_, shapes_, root_, of_bodies_);
    if (robots > 0 && collections_.empty()) {
      scene_.world.gravity = {0, 0, -9.81};
      scene_.notes.push_back("z is up, because the file holds a robot of OpenHRP's prototypes");
    }
    sort_world(draft_, {file_, 0, ""});
    plan_parts(draft_);
    scene_.world.name = scene_.name;
    if (const std::string fault = world::find_fault(scene_.world); !fault.empty())
      throw config::ConfigError({file_, 0, ""}, fault);
    return std::move(scene_);
  }

 private:
  [[noreturn]] void fail(const X3dNode& node, const std::string& message) const {
    fail_at(node, file_, message);
  }
  config::Place place_of(const X3dNode& node) const { return shapes_.place_of(node); }
  std::vector<double> numbers(const X3dNode& node, const std::string& field, std::size_t count,
                              const std::vector<double>& otherwise) const {
    return numbers_of(node, field, count, otherwise, file_);
  }
  Eigen::Vector3d vector(const X3dNode& node, const std::string& field,
                         const Eigen::Vector3d& otherwise) const {
    const auto xyz = numbers(node, field, 3, {otherwise[0], otherwise[1], otherwise[2]});
    return {xyz[0], xyz[1], xyz[2]};
  }
  Eigen::Quaterniond rotation(const X3dNode& node, const std::string& field) const {
    return quaternion_of_rotation(numbers(node, field, 4, {0, 0, 1, 0}).data());
  }

  // Notes collections, and which shapes belong to bodies.
  void index(const X3dNode& node) {
    if (node.type == "RigidBodyCollection") collections_.push_back(&node);
    for (const auto& [field, child] : node.children) index(child);
    if (node.type != "CollidableShape") return;
    if (const X3dNode* shape = x3d_child(node, "shape")) of_bodies_.insert(&resolved(*shape));
  }

  const X3dNode& resolved(const X3dNode& node) const { return shapes_.resolved(node); }
  std::optional<Node> metadata(const X3dNode& node) const { return shapes_.metadata(node); }
  std::string name_of(const X3dNode& node, const std::optional<Node>& metadata, const char* what,
                      std::size_t number) const {
    return shapes_.name_of(node, metadata, what, number);
  }

  void read_settings(const X3dNode& collection) {
    scene_.world.gravity = vector(collection, "gravity", {0, -9.8, 0});
    const auto known = metadata(collection);
    if (!known) return;
    const Eigen::Vector3d gravity = scene_.world.gravity;
    scene::read_settings(draft_, *known);
    scene_.world.gravity = gravity;
    read_engines(draft_, *known);
    read_surfaces(draft_, *known);
  }

  // Reads what only metadata says about the bodies and joints of a collection.
  void read_rest(const X3dNode& collection) {
    const auto known = metadata(collection);
    if (!known) return;
    if (const auto pairs = known->find("no_collision")) read_no_collision(draft_, *pairs, "");
    if (const auto parts = known->find("parts")) read_motors(draft_, *parts, motors_);
  }

  void read_body(const X3dNode& node) {
    if (node.type != "RigidBody") fail(node, "is not a RigidBody");
    const auto known = metadata(node);
    world::Body body;
    body.name = name_of(node, known, "body_", scene_.world.bodies.size());
    body.fixed = flag_of(node, "fixed", false, file_);
    body.X_WB = x3d_exact_pose(
        known, {vector(node, "position", Eigen::Vector3d::Zero()), rotation(node, "orientation")});
    if (!body.fixed) read_mass(node, body);
    if (!body.fixed && known && known->find("engine")) body.engine = draft_.engine(known->get("engine"));
    bodies_[&node] = draft_.add_body(body, place_of(node));
    for (const auto& [field, child] : node.children)
      if (field == "geometry") read_collidable(resolved(child), bodies_[&node], {}, 0);
  }

  void read_mass(const X3dNode& node, world::Body& body) const {
    body.mass_kg = numbers(node, "mass", 1, {1.0})[0];
    body.p_BC = vector(node, "centerOfMass", Eigen::Vector3d::Zero());
    const auto rows = numbers(node, "inertia", 9, {1, 0, 0, 0, 1, 0, 0, 0, 1});
    for (int i = 0; i < 9; ++i) body.inertia_C(i / 3, i % 3) = rows[static_cast<std::size_t>(i)];
    if (body.inertia_C != body.inertia_C.transpose()) fail(node, "inertia must be symmetric");
    body.v_WB = vector(node, "linearVelocity", Eigen::Vector3d::Zero());
    body.w_WB = vector(node, "angularVelocity", Eigen::Vector3d::Zero());
  }

  void read_collidable(const X3dNode& node, world::BodyId body, const Pose& X_BN, int depth) {
    const Pose X_BC =
        X_BN * Pose{vector(node, "translation", Eigen::Vector3d::Zero()), rotation(node, "rotation")};
    if (node.type == "CollidableOffset") {
      if (depth > kMaxX3dDepth)
        fail(node, "offsets are nested more than " + std::to_string(kMaxX3dDepth) + " deep");
      if (const X3dNode* inner = x3d_child(node, "collidable"))
        read_collidable(resolved(*inner), body, X_BC, depth + 1);
      return;
    }
    if (node.type != "CollidableShape") fail(node, "is neither a CollidableShape nor a CollidableOffset");
    const X3dNode* shape = x3d_child(node, "shape");
    if (!shape) fail(node, "has no shape");
    shapes_.add(resolved(*shape), body, {X_BC, Eigen::Matrix3d::Identity()},
                flag_of(node, "enabled", true, file_), metadata(node));
  }

  const X3dNode* body_node(const X3dNode& joint, const char* field) const {
    const X3dNode* child = x3d_child(joint, field);
    if (!child) return nullptr;
    const X3dNode& body = resolved(*child);
    if (!bodies_.contains(&body))
      fail(*child, std::string(field) + " is not a body of a RigidBodyCollection");
    return &body;
  }

  static std::optional<JointKind> kind_of(const std::string& type) {
    static const std::map<std::string, JointKind> kinds{{"SingleAxisHingeJoint", JointKind::kHinge},
                                                        {"SliderJoint", JointKind::kSlider},
                                                        {"BallJoint", JointKind::kBall},
                                                        {"UniversalJoint", JointKind::kUniversal},
                                                        {"DoubleAxisHingeJoint", JointKind::kUniversal}};
    const auto found = kinds.find(type);
    return found == kinds.end() ? std::nullopt : std::optional(found->second);
  }

  void read_joint(const X3dNode& node) {
    const auto kind = kind_of(node.type);
    if (!kind) {
      if (node.type != "MotorJoint") fail(node, "is not a joint");
      if (const auto motor = metadata(node)) {
        motors_.insert(motor->get("joint").text());
        return;
      }
      scene_.losses.push_back("line " + std::to_string(node.line) +
                              ": a MotorJoint is not read: in Visum, hardware parts drive joints");
      return;
    }
    if (node.type == "DoubleAxisHingeJoint")
      scene_.losses.push_back(
          "line " + std::to_string(node.line) +
          ": a DoubleAxisHingeJoint is read as a universal joint: without suspension, motors and stops");
    const auto known = metadata(node);
    world::Joint joint;
    joint.kind = *kind;
    joint.name = name_of(node, known, "joint_", scene_.world.joints.size());
    const double sign = connect(node, joint);
    place(node, known, sign, joint);
    if (joint.kind == JointKind::kHinge || joint.kind == JointKind::kSlider) read_freedom(node, known, joint);
    draft_.add_joint(joint, place_of(node));
  }

  // Finds parent and child. Returns -1 if the file has them the other way round, else 1.
  double connect(const X3dNode& node, world::Joint& joint) const {
    const X3dNode* first = body_node(node, "body1");
    const X3dNode* second = body_node(node, "body2");
    const auto moves = [&](const X3dNode* body) {
      return body && !scene_.world.bodies[bodies_.at(body).index()].fixed;
    };
    if (!moves(first) && !moves(second)) fail(node, "needs a body that moves");
    const bool turned = !moves(second);
    const X3dNode* parent = turned ? second : first;
    joint.child = bodies_.at(turned ? first : second);
    if (parent) joint.parent = bodies_.at(parent);
    if (joint.parent == joint.child) fail(node, "joins a body to itself");
    return turned ? -1.0 : 1.0;
  }

  void place(const X3dNode& node, const std::optional<Node>& known, double sign, world::Joint& joint) const {
    const auto& bodies = scene_.world.bodies;
    const Pose X_WP = joint.parent.valid() ? bodies[joint.parent.index()].X_WB : Pose{};
    const bool two = joint.kind == JointKind::kUniversal;
    const Eigen::Vector3d child = bodies[joint.child.index()].X_WB.p;
    const Eigen::Vector3d anchor_W =
        vector(node, "anchorPoint", joint.kind == JointKind::kSlider ? child : Eigen::Vector3d::Zero());
    joint.X_PJ = {X_WP.inverse() * anchor_W, Eigen::Quaterniond::Identity()};
    const auto axis = [&](const char* field, const Eigen::Vector3d& usual) {
      const Eigen::Vector3d axis_W = vector(node, field, usual);
      if (!(axis_W.norm() > 1e-6)) fail(node, std::string(field) + " must not be zero");
      return Eigen::Vector3d(sign * (X_WP.q.conjugate() * axis_W.normalized()));
    };
    if (joint.kind != JointKind::kBall)
      joint.axis_J = axis(two ? "axis1" : "axis", two ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d::UnitY());
    if (two) joint.axis2_J = axis("axis2", Eigen::Vector3d::UnitX());
    if (two && std::abs(joint.axis_J.dot(joint.axis2_J)) > kSame)
      fail(node, "axis1 and axis2 must be perpendicular");
    if (known) exact_place(*known, joint);
    joint.X_CJ = bodies[joint.child.index()].X_WB.inverse() * (X_WP * joint.X_PJ);
  }

  // Restores the frame that the joint had, if it means the same place and axis.
  static void exact_place(const Node& known, world::Joint& joint) {
    const Pose X_PJ = read_pose_or_identity(known, "pose");
    const Eigen::Vector3d axis_J = read_axis(known.get("axis"));
    const bool ball = joint.kind == JointKind::kBall;
    const bool placed = joint.kind == JointKind::kSlider || (X_PJ.p - joint.X_PJ.p).norm() < kSame;
    if (!placed || (!ball && (X_PJ.q * axis_J - joint.axis_J).norm() > kSame)) return;
    const auto axis2 = known.find("axis2");
    if (axis2 && (X_PJ.q * read_axis(*axis2) - joint.axis2_J).norm() > kSame) return;
    if (axis2) joint.axis2_J = read_axis(*axis2);
    joint.X_PJ = X_PJ;
    joint.axis_J = axis_J;
  }

  void read_freedom(const X3dNode& node, const std::optional<Node>& known, world::Joint& joint) const {
    const bool turns = joint.kind == JointKind::kHinge;
    const char* low = turns ? "minAngle" : "minSeparation";
    const char* high = turns ? "maxAngle" : "maxSeparation";
    if (node.values.contains(low) || node.values.contains(high)) {
      joint.limited = true;
      joint.lower = numbers(node, low, 1, {turns ? -3.141592653589793 : 0.0})[0];
      joint.upper = numbers(node, high, 1, {turns ? 3.141592653589793 : 1.0})[0];
      if (joint.lower > joint.upper) fail(node, std::string(low) + " is above " + high);
    }
    joint.stop_restitution = numbers(node, "stopBounce", 1, {0.0})[0];
    joint.initial_position = nearest_to_zero(joint);
    if (!known) return;
    joint.friction = known->number_or("friction", 0.0, config::kNonNegative);
    joint.damping = known->number_or("damping", 0.0, config::kNonNegative);
    const double lowest = joint.limited ? joint.lower : -1e6, highest = joint.limited ? joint.upper : 1e6;
    joint.initial_position = known->number_or("position", joint.initial_position, {lowest, highest});
  }

  const X3dNode& root_;
  const std::string file_;
  Scene scene_;
  Draft draft_;
  X3dShapes shapes_;
  std::vector<const X3dNode*> collections_;
  std::set<const X3dNode*> of_bodies_;  // only used to ask if they hold a shape
  std::map<const X3dNode*, world::BodyId> bodies_;
  std::set<std::string> motors_;  // joints with a MotorJoint
};

}  // namespace

Scene scene_of_x3d(const X3dNode& root, const std::filesystem::path& file) {
  return Importer(root, file).read();
}

}  // namespace visum::scene

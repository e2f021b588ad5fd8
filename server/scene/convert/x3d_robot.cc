#include "server/scene/convert/x3d_robot.h"

#include <algorithm>
#include <set>

#include "server/scene/convert/x3d_text.h"
#include "server/scene/convert/yaml_text.h"
#include "server/scene/joints.h"
#include "server/scene/link_mass.h"
#include "server/scene/values.h"

namespace visum::scene {
namespace {

using world::JointKind;
using world::Pose;

constexpr double kDensity = 1000.0;  // kg/m³, of links without a mass
constexpr std::size_t kMaxNamed = 8;

// The prototypes of sensors and lamps, of OpenHRP and Choreonoid.
const std::set<std::string>& devices() {
  static const std::set<std::string> names{"VisionSensor",       "ForceSensor",    "Gyro",
                                           "AccelerationSensor", "PressureSensor", "PhotoInterrupter",
                                           "RangeSensor",        "ExtraJoint",     "SpotLightDevice"};
  return names;
}

bool has_joint(const X3dNode& node) {
  return node.prototype == "Joint" ||
         std::ranges::any_of(node.children, [](const X3dChild& child) { return has_joint(child.node); });
}

class RobotReader {
 public:
  RobotReader(Draft& draft, X3dShapes& shapes, const X3dNode& humanoid)
      : draft_(draft), shapes_(shapes), humanoid_(humanoid) {}

  void read(const X3dFrame& frame) {
    Link world;  // the Humanoid itself: whatever hangs on no Joint
    world.frame = humanoid_.type == "Transform" ? shapes_.inside(humanoid_, frame) : frame;
    gather(humanoid_, world.frame, world, 0);
    for (const auto& [node, X_WN] : world.joints) add_link(*node, X_WN, {}, 0);
    keep_links_apart();
    add_part();
    tell();
  }

 private:
  struct Link {
    X3dFrame frame;  // in W
    MassProperties mass;
    std::vector<world::Shape> shapes;
    std::vector<config::Place> shape_places;
    std::vector<std::pair<const X3dNode*, X3dFrame>> joints;  // below it, in its frame
  };

  // Collects what belongs to a link: everything below it, down to the next Joints.
  void gather(const X3dNode& parent, const X3dFrame& frame, Link& link, int depth) {
    for (const X3dNode* child : shapes_.shown(parent)) {
      const X3dNode& node = shapes_.resolved(*child);
      if (depth > kMaxX3dTreeDepth)
        shapes_.fail(*child, "nodes are nested more than " + std::to_string(kMaxX3dTreeDepth) + " deep");
      if (++visits_ > kMaxX3dNodes)
        shapes_.fail(*child, "with every USE written out the robot has more than " +
                                 std::to_string(kMaxX3dNodes) + " nodes");
      if (node.prototype == "Joint") {
        link.joints.emplace_back(&node, frame);
        continue;
      }
      if (node.type == "Shape") {
        take_shape(node, frame, link);
        continue;
      }
      if (devices().contains(node.prototype)) devices_.push_back(title_of(node));
      const X3dFrame inner = node.type == "Transform" ? shapes_.inside(node, frame) : frame;
      if (node.prototype == "Segment") take_mass(node, inner, link);
      gather(node, inner, link, depth + 1);
    }
  }

  void take_shape(const X3dNode& node, const X3dFrame& frame, Link& link) {
    const auto shape = shapes_.shape_of(node, frame, link.shapes.size());
    if (!shape) return;
    link.shapes.push_back(*shape);
    link.shape_places.push_back(shapes_.place_of(node));
  }

  // The fields that the file gave to a prototype, as those of a node.
  static X3dNode fields_of(const X3dNode& node) {
    X3dNode fields;
    fields.type = node.type;
    fields.prototype = node.prototype;
    fields.def = node.def;
    fields.line = node.line;
    fields.file = node.file;
    fields.values = node.given;
    std::erase_if(fields.values, [](const auto& entry) { return entry.second.empty(); });
    return fields;
  }

  void take_mass(const X3dNode& node, const X3dFrame& frame, Link& link) const {
    const X3dNode fields = fields_of(node);
    MassProperties mass;
    mass.mass_kg = number(fields, "mass", 0.0);
    if (!(mass.mass_kg > 0.0)) return;
    mass.com = shapes_.vector(fields, "centerOfMass", Eigen::Vector3d::Zero());
    const auto rows = numbers_of(fields, "momentsOfInertia", 9, std::vector<double>(9, 0.0), shapes_.file());
    for (int i = 0; i < 9; ++i) mass.inertia_C(i / 3, i % 3) = rows[static_cast<std::size_t>(i)];
    mass.inertia_C = Eigen::Matrix3d(0.5 * (mass.inertia_C + mass.inertia_C.transpose()));
    link.mass = together(link.mass, moved(mass, frame.X));
  }

  double number(const X3dNode& fields, const std::string& name, double otherwise) const {
    return numbers_of(fields, name, 1, {otherwise}, shapes_.file())[0];
  }

  static std::string text(const X3dNode& fields, const std::string& name) {
    const auto found = fields.values.find(name);
    return found == fields.values.end() ? "" : found->second;
  }

  void add_link(const X3dNode& node, const X3dFrame& outer, world::BodyId parent, int depth) {
    if (depth > kMaxX3dTreeDepth)
      shapes_.fail(node, "joints are nested more than " + std::to_string(kMaxX3dTreeDepth) + " deep");
    if (links_.size() == kMaxX3dLinks)
      shapes_.fail(node, "the robot has more than " + std::to_string(kMaxX3dLinks) + " links");
    const X3dNode fields = fields_of(node);
    Link link;
    link.frame = node.type == "Transform" ? shapes_.inside(node, outer) : outer;
    gather(node, {Pose{}, link.frame.stretch}, link, 0);
    const auto kind = kind_of(fields, parent);
    const bool on_ground = !parent.valid() || draft_.scene.world.bodies[parent.index()].fixed;
    world::Body body;
    body.name = free_name(node);
    body.fixed = kind == JointKind::kFixed && on_ground;
    body.X_WB = link.frame.X;
    if (!body.fixed) set_mass(node, link, body);
    const world::BodyId id = draft_.add_body(body, shapes_.place_of(node));
    links_.push_back(id);
    for (std::size_t i = 0; i < link.shapes.size(); ++i) {
      link.shapes[i].body = id;
      draft_.add_shape(link.shapes[i], link.shape_places[i]);
    }
    if (kind && !body.fixed) add_joint(node, fields, *kind, parent, id);
    for (const auto& [child, frame] : link.joints)
      add_link(*child, {link.frame.X * frame.X, frame.stretch}, id, depth + 1);
  }

  void set_mass(const X3dNode& node, const Link& link, world::Body& body) {
    const auto [mass, repair] = repaired_mass(link.mass, link.shapes, draft_.scene.world.meshes, kDensity);
    if (!repair.empty()) {
      const std::string sentence = "link '" + body.name + "' " + repair;
      draft_.scene.repairs.push_back({file_of(node, shapes_.file()), {sentence, node.line}});
      draft_.scene.losses.push_back(sentence);
    }
    body.mass_kg = mass.mass_kg;
    body.p_BC = mass.com;
    body.inertia_C = mass.inertia_C;
  }

  // The name of its DEF, or one with a number if that is taken or no name.
  std::string free_name(const X3dNode& node) const {
    std::string name = flat_name(name_in_file(node));
    if (!name_fault(name).empty()) name = "link";
    std::string free = name == "link" ? "link_0" : name;
    for (std::size_t i = draft_.scene.world.bodies.size(); draft_.body(free).valid(); ++i)
      free = name + "_" + std::to_string(i);
    return free;
  }

  // Nothing: it is free to move.
  std::optional<JointKind> kind_of(const X3dNode& fields, world::BodyId parent) const {
    const std::string type = text(fields, "jointType");
    if (type == "rotate" || type == "revolute") return JointKind::kHinge;
    if (type == "slide" || type == "prismatic") return JointKind::kSlider;
    if (type == "fixed") return JointKind::kFixed;
    if (type == "free" || (type.empty() && !parent.valid())) return {};
    shapes_.lose(fields, "joint '" + name_in_file(fields) + "' has the type '" + type +
                             "', which is not simulated: it is fixed to its parent");
    return JointKind::kFixed;
  }

  void add_joint(const X3dNode& node, const X3dNode& fields, JointKind kind, world::BodyId parent,
                 world::BodyId child) {
    const auto& bodies = draft_.scene.world.bodies;
    const world::Body& body = bodies[child.index()];
    world::Joint joint;
    joint.kind = kind;
    joint.name = body.name;
    joint.parent = parent;
    joint.child = child;
    joint.X_PJ = parent.valid() ? bodies[parent.index()].X_WB.inverse() * body.X_WB : body.X_WB;
    if (kind != JointKind::kFixed) {
      joint.axis_J = axis_of(fields);
      read_limits(fields, joint);
      driven_.push_back(joint.name);
      if (number(fields, "rotorInertia", 0.0) > 0.0) ++rotors_;
    }
    draft_.add_joint(joint, shapes_.place_of(node));
  }

  // Three numbers, or in old files a letter.
  Eigen::Vector3d axis_of(const X3dNode& fields) const {
    const std::string letter = text(fields, "jointAxis");
    if (letter == "X" || letter == "x") return Eigen::Vector3d::UnitX();
    if (letter == "Y" || letter == "y") return Eigen::Vector3d::UnitY();
    if (letter == "Z" || letter == "z") return Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d axis = shapes_.vector(fields, "jointAxis", Eigen::Vector3d::UnitZ());
    if (!(axis.norm() > 1e-6)) shapes_.fail(fields, "jointAxis must not be zero");
    return axis.normalized();
  }

  void read_limits(const X3dNode& fields, world::Joint& joint) {
    const auto limit = [&](const char* name) { return numbers_of(fields, name, 0, {}, shapes_.file()); };
    const auto lower = limit("llimit"), upper = limit("ulimit");
    if (!lower.empty() && !upper.empty() && lower[0] < upper[0]) {
      joint.limited = true;
      joint.lower = lower[0];
      joint.upper = upper[0];
    } else if (!lower.empty() || !upper.empty()) {
      shapes_.lose(fields, "joint '" + joint.name + "' has no stops: llimit must be below ulimit");
    }
    joint.initial_position = nearest_to_zero(joint);
    const auto slowest = limit("lvlimit"), fastest = limit("uvlimit");
    if (!slowest.empty() && !fastest.empty())
      draft_.drive_limits[joint.name].speed = std::max(std::abs(slowest[0]), std::abs(fastest[0]));
  }

  void keep_links_apart() {
    for (std::size_t a = 0; a < links_.size(); ++a)
      for (std::size_t b = a + 1; b < links_.size(); ++b) draft_.forbid_collision(links_[a], links_[b]);
  }

  void add_part() {
    if (driven_.empty()) return;
    std::string joints;
    for (const std::string& name : driven_) joints += (joints.empty() ? "" : ", ") + yaml_text(name);
    part_ = flat_name(name_in_file(humanoid_));
    if (!name_fault(part_).empty()) part_ = "robot";
    draft_.part_entries.push_back(
        config::load_text("{name: " + yaml_text(part_) + ", kind: ideal_joints, joints: [" + joints + "]}",
                          shapes_.file(), std::filesystem::path(shapes_.file()).parent_path()));
  }

  void tell() {
    if (links_.size() > 1)
      draft_.scene.notes.push_back("the links of '" + name_in_file(humanoid_) +
                                   "' do not collide with each other");
    if (rotors_ > 0)
      shapes_.lose(humanoid_,
                   "the inertia of rotors is not simulated; " + std::to_string(rotors_) + " joints have one");
    if (devices_.empty()) return;
    std::string names;
    for (std::size_t i = 0; i < std::min(devices_.size(), kMaxNamed); ++i)
      names += (i == 0 ? "" : ", ") + devices_[i];
    if (devices_.size() > kMaxNamed) names += " and " + std::to_string(devices_.size() - kMaxNamed) + " more";
    shapes_.lose(humanoid_, "devices are not read: " + names);
  }

  Draft& draft_;
  X3dShapes& shapes_;
  const X3dNode& humanoid_;
  std::vector<world::BodyId> links_;
  std::vector<std::string> driven_, devices_;
  std::string part_;
  std::size_t visits_ = 0, rotors_ = 0;
};

}  // namespace

bool is_x3d_robot(const X3dNode& node) {
  return node.prototype == "Humanoid" && has_joint(node);
}

void read_x3d_robot(Draft& draft, X3dShapes& shapes, const X3dNode& humanoid, const X3dFrame& frame) {
  RobotReader(draft, shapes, humanoid).read(frame);
}

}  // namespace visum::scene

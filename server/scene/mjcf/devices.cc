#include "server/scene/mjcf/devices.h"

#include <algorithm>
#include <cmath>

#include "protocol/config/unknown_name.h"
#include "server/scene/model_errors.h"
#include "server/world/joint_kinds.h"

namespace visum::scene::mjcf {
namespace {

using world::JointKind;

const std::vector<std::string_view> kActuators = {"general",     "motor",  "position", "velocity",
                                                  "intvelocity", "damper", "cylinder", "muscle",
                                                  "adhesion",    "dcmotor"};

// The larger end of a range; 0 if the range does not hold.
double most_of(const Values& values, std::string_view range, std::string_view limited, bool auto_limits) {
  const auto given = values.numbers(range, 2, 2);
  if (!given || !values.flag(limited).value_or(auto_limits)) return 0.0;
  return std::max(std::abs((*given)[0]), std::abs((*given)[1]));
}

RobotJoint& find_joint(Reading& reading, const std::string& name, const Element& user) {
  std::vector<std::string> known;
  for (RobotJoint& joint : reading.model.joints) {
    if (joint.joint.name == name) return joint;
    if (joint.joint.kind != JointKind::kFixed) known.push_back(joint.joint.name);
  }
  user.fail(config::unknown_name("joint", name, known));
}

void read_actuator(Reading& reading, const Element& element) {
  const Values values = reading.defaults.of(element, "", kActuators);
  const std::string* joint_name = values.text("joint");
  if (joint_name == nullptr) joint_name = values.text("jointinparent");
  if (joint_name == nullptr)
    return reading.losses.add("actuators of anything but joints are not read", element);
  bool free = false;  // free joints are no joints here
  each_child(reading.root, "worldbody", [&](const Element& world) {
    each_child(world, "body", [&](const Element& body) {
      for (const Element& child : body.children)
        free = free || ((child.tag == "freejoint" || child.tag == "joint") && child.name() == *joint_name &&
                        (child.tag == "freejoint" || child.attribute("type") != nullptr) &&
                        (child.tag == "freejoint" || *child.attribute("type") == "free"));
    });
  });
  if (free) return reading.losses.add("actuators of free joints are not read", element);
  RobotJoint& joint = find_joint(reading, *joint_name, element);
  if (!world::is_drivable(joint.joint.kind))
    return reading.losses.add("actuators of ball joints are not read", element);
  const bool limits = reading.settings.auto_limits;
  const double gear = std::abs(values.numbers("gear", 1, 6).value_or(std::vector<double>{1.0})[0]);
  double effort = most_of(values, "forcerange", "forcelimited", limits);
  const double control = most_of(values, "ctrlrange", "ctrllimited", limits);
  if (element.tag == "motor" && control > 0) effort = effort > 0 ? std::min(effort, control) : control;
  joint.maximum_effort = std::max(joint.maximum_effort, effort * gear);
  if (element.tag == "velocity" && control > 0 && gear > 0)
    joint.maximum_speed = std::max(joint.maximum_speed, control / gear);
  auto& actuated = reading.model.actuated;
  if (std::find(actuated.begin(), actuated.end(), *joint_name) == actuated.end())
    actuated.push_back(*joint_name);
}

// Two bodies that a constraint names, and the place of the joint in each. The second one moves.
struct Ends {
  std::size_t parent, child;
  world::Pose X_PJ, X_CJ;
};

class Equalities {
 public:
  Equalities(Reading& reading, const std::vector<BodyEntry>& bodies) : reading_(reading), bodies_(bodies) {
    X_MB_.resize(bodies.size());
    for (std::size_t i = 1; i < bodies.size(); ++i) X_MB_[i] = X_MB_[bodies[i].parent] * bodies[i].X_PB;
  }

  void read(const Element& entry) {
    if (Values(entry, {}).flag("active") == false)
      return reading_.losses.add("constraints that are not active are not read", entry);
    const bool connects = entry.tag == "connect";
    if (!connects && entry.tag != "weld")
      return reading_.losses.add("constraints of the kind <" + entry.tag + "> are not simulated", entry);
    if (!entry.attribute("body1"))
      return reading_.losses.add("constraints between sites are not simulated", entry);
    const std::size_t one = find_body(bodies_, *entry.attribute("body1"), entry);
    const std::string* second = entry.attribute("body2");
    const std::size_t other = second ? find_body(bodies_, *second, entry) : 0;
    if (bodies_[one].mocap || bodies_[other].mocap)
      return reading_.losses.add("nothing is tied to a mocap body", entry);
    if (!bodies_[one].moves && !bodies_[other].moves)
      return reading_.losses.add("constraints between bodies that stand still are not read", entry);
    if (bodies_[one].group == bodies_[other].group)
      return reading_.losses.add("constraints of a body with itself are not read", entry);
    add(entry, connects, connects ? connected(entry, one, other) : welded(entry, one, other));
  }

 private:
  // The place where the other body meets it is the one in the pose of the file.
  Ends connected(const Element& entry, std::size_t one, std::size_t other) const {
    const auto n = numbers_of(entry, "anchor", 3, 3);
    const world::Pose X_1J{{n[0], n[1], n[2]}, Eigen::Quaterniond::Identity()};
    return {one, other, X_1J, X_MB_[other].inverse() * X_MB_[one] * X_1J};
  }

  Ends welded(const Element& entry, std::size_t one, std::size_t other) const {
    world::Pose X_12 = X_MB_[one].inverse() * X_MB_[other];
    if (entry.attribute("relpose")) {
      const auto n = numbers_of(entry, "relpose", 7, 7);
      const Eigen::Quaterniond q(n[3], n[4], n[5], n[6]);
      if (q.norm() > 0) X_12 = {{n[0], n[1], n[2]}, q.normalized()};
    }
    return {one, other, X_12, {}};
  }

  void add(const Element& entry, bool connects, Ends ends) {
    if (!bodies_[ends.child].moves) {
      std::swap(ends.parent, ends.child);
      std::swap(ends.X_PJ, ends.X_CJ);
    }
    RobotJoint joint;
    joint.joint.name = entry.name().empty() ? entry.tag + "_" + std::to_string(++count_) : entry.name();
    joint.joint.kind = connects ? JointKind::kBall : JointKind::kFixed;
    joint.joint.X_PJ = ends.X_PJ;
    joint.joint.X_CJ = ends.X_CJ;
    joint.parent = link(ends.parent);
    joint.child = link(ends.child);
    joint.line = entry.line;
    joint.file = *entry.file == reading_.model.file.string() ? "" : *entry.file;
    joint.closes_loop = true;
    for (const RobotJoint& known : reading_.model.joints)
      if (known.joint.name == joint.joint.name) joint.joint.name += "_" + entry.tag;
    reading_.model.joints.push_back(std::move(joint));
  }

  std::string link(std::size_t body) const { return body == 0 ? kWorldLink : bodies_[body].name; }

  Reading& reading_;
  const std::vector<BodyEntry>& bodies_;
  std::vector<world::Pose> X_MB_;  // in the pose of the file
  std::size_t count_ = 0;
};

std::size_t coordinates(const BodyEntry& body) {
  std::size_t count = body.free ? 7 : 0;
  for (const JointEntry& joint : body.joints) count += joint.type == JointType::kBall ? 4 : 1;
  return count;
}

Eigen::Quaterniond quaternion(const double* n) {
  const Eigen::Quaterniond q(n[0], n[1], n[2], n[3]);
  return q.norm() > 1e-10 ? q.normalized() : Eigen::Quaterniond::Identity();
}

void start_at(const std::vector<double>& q, std::vector<BodyEntry>& bodies) {
  const double* next = q.data();
  for (BodyEntry& body : bodies) {
    if (body.free) {
      body.X_WB = world::Pose{{next[0], next[1], next[2]}, quaternion(next + 3)};
      next += 7;
    }
    for (JointEntry& joint : body.joints) {
      if (joint.type == JointType::kBall)
        joint.turned = quaternion(next);
      else
        joint.initial = *next;
      next += joint.type == JointType::kBall ? 4 : 1;
    }
  }
}

}  // namespace

void read_actuators(Reading& reading) {
  std::size_t count = 0;
  each_child(reading.root, "actuator", [&](const Element& section) {
    for (const Element& element : section.children) {
      ++count;
      if (std::find(kActuators.begin(), kActuators.end(), element.tag) == kActuators.end())
        reading.losses.add("<" + element.tag + "> is not read", element);
      else if (reading.errors.size() < kMaxErrors)
        keep_error(reading.errors, [&] { read_actuator(reading, element); });
    }
  });
  if (!reading.model.actuated.empty())
    reading.model.notes.push_back(
        std::to_string(reading.model.actuated.size()) +
        " joints have an actuator: parts drive them within its limits, without its law");
}

void read_equalities(Reading& reading, const std::vector<BodyEntry>& bodies) {
  Equalities equalities(reading, bodies);
  each_child(reading.root, "equality", [&](const Element& section) {
    for (const Element& entry : section.children)
      if (reading.errors.size() < kMaxErrors) keep_error(reading.errors, [&] { equalities.read(entry); });
  });
}

void read_home(Reading& reading, std::vector<BodyEntry>& bodies) {
  std::size_t wanted = 0;
  for (const BodyEntry& body : bodies) wanted += coordinates(body);
  each_child(reading.root, "keyframe", [&](const Element& section) {
    each_child(section, "key", [&](const Element& key) {
      if (key.name() != "home") return reading.losses.add("keyframes but 'home' are not read", key);
      if (!key.attribute("qpos")) return;
      keep_error(reading.errors, [&] {
        start_at(numbers_of(key, "qpos", wanted, wanted), bodies);
        reading.model.notes.push_back("it starts in the keyframe 'home'");
      });
    });
  });
}

void note_unread(Reading& reading) {
  for (const char* tag : {"sensor", "tendon", "deformable", "extension"})
    each_child(reading.root, tag, [&](const Element& section) {
      for (const Element& child : section.children)
        reading.losses.add("what stands in <" + std::string(tag) + "> is not read", child);
    });
  each_child(reading.root, "option", [&](const Element& option) {
    for (const char* medium : {"wind", "density", "viscosity"})
      if (option.attribute(medium))
        reading.losses.add(std::string(medium) + " of the medium is not simulated", option);
  });
  each_child(reading.root, "asset", [&](const Element& section) {
    for (const Element& child : section.children)
      if (child.tag == "texture" || child.tag == "skin" || child.tag == "model")
        reading.losses.add("<" + child.tag + "> is not read", child);
  });
}

}  // namespace visum::scene::mjcf

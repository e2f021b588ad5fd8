#include "server/scene/mjcf/links.h"

#include <algorithm>
#include <cmath>

#include "server/scene/model_errors.h"

namespace visum::scene::mjcf {
namespace {

using Eigen::Vector3d;
using world::JointKind;

constexpr double kSpringLengthM = 100.0;  // from a slide joint's spring to its far end: it never gets there
constexpr double kMaxPosition = 1e6;
constexpr double kMaxLoss = 1e6;
constexpr double kLeastMassKg = 1e-8;

world::Pose at(const Vector3d& p) {
  return {p, Eigen::Quaterniond::Identity()};
}

class LinkMaker {
 public:
  LinkMaker(Reading& reading, const std::vector<BodyEntry>& bodies) : reading_(reading), bodies_(bodies) {}

  void make() {
    group_masses_.resize(bodies_.size());
    for (std::size_t i = 1; i < bodies_.size(); ++i)
      group_masses_[bodies_[i].group] = together(group_masses_[bodies_[i].group], bodies_[i].mass);
    if (!bodies_[0].geoms.empty()) {
      RobotLink ground = link(bodies_[0], kWorldGeoms);
      ground.on_ground = true;
      add_shapes(bodies_[0], ground);
      reading_.model.links.push_back(std::move(ground));
    }
    X_MB_.resize(bodies_.size());
    for (std::size_t i = 1; i < bodies_.size(); ++i) make_body(i);
  }

 private:
  std::string file_of(const Element& element) const {
    return *element.file == reading_.model.file.string() ? std::string() : *element.file;
  }

  RobotLink link(const BodyEntry& body, const std::string& name) const {
    RobotLink link;
    link.name = name;
    link.line = body.element->line;
    link.file = file_of(*body.element);
    return link;
  }

  void add_shapes(const BodyEntry& body, RobotLink& link) const {
    for (const Geom& geom : body.geoms)
      for (RobotShape shape : geom.shapes) {
        shape.link = link.name;
        link.shapes.push_back(std::move(shape));
      }
  }

  void make_body(std::size_t index) {
    const BodyEntry& body = bodies_[index];
    RobotLink own = link(body, body.name);
    own.mass = body.mass;
    add_shapes(body, own);
    const world::Pose X_MP = X_MB_[body.parent];
    std::string above = link_of(bodies_, body.parent);
    X_MB_[index] = body.X_WB.value_or(X_MP * body.X_PB);
    if (body.joints.empty()) {
      if (!body.free && body.parent == 0) own.on_ground = true;
      if (!body.free && body.parent != 0) add_fixed(body, above);
    }
    world::Pose X_PB = body.X_PB;  // from the link above to the body's frame
    for (std::size_t k = 0; k < body.joints.size(); ++k) {
      const bool last = k + 1 == body.joints.size();
      const std::string below = last ? body.name : body.name + "~" + body.joints[k].name;
      const world::Pose X_PC = add_joint(body, body.joints[k], above, below, X_PB);
      X_MB_[index] = k == 0 ? X_MP * X_PC : X_MB_[index] * X_PC;
      if (!last) {
        RobotLink between = link(body, below);
        between.X_ML = X_MB_[index];
        between.mass = share_of(index, own.mass);
        reading_.model.links.push_back(std::move(between));
      }
      above = below;
      X_PB = {};
    }
    own.X_ML = X_MB_[index];
    reading_.model.links.push_back(std::move(own));
  }

  // Takes the mass of a link between joints from the body's own. A body without mass has that of the bodies
  // that are fixed to it; then the share is added.
  MassProperties share_of(std::size_t index, MassProperties& own) const {
    const BodyEntry& body = bodies_[index];
    if (body.mass.mass_kg * kShareBetweenJoints > kLeastMassKg) {
      const MassProperties share = scaled(body.mass, kShareBetweenJoints);
      own = scaled(own, (own.mass_kg - share.mass_kg) / own.mass_kg);
      return share;
    }
    const MassProperties& all = group_masses_[index];
    if (all.mass_kg > 0) return scaled(all, std::max(kShareBetweenJoints, kLeastMassKg / all.mass_kg));
    return {kLeastMassKg, Vector3d::Zero(), kLeastMassKg * 0.01 * Eigen::Matrix3d::Identity()};
  }

  void add_fixed(const BodyEntry& body, const std::string& above) {
    RobotJoint joint;
    joint.joint.name = body.name + "_fixed";
    joint.joint.kind = JointKind::kFixed;
    joint.joint.X_PJ = body.X_PB;
    joint.parent = above;
    joint.child = body.name;
    joint.line = body.element->line;
    joint.file = file_of(*body.element);
    reading_.model.joints.push_back(std::move(joint));
  }

  // Returns the pose of the child's frame in the parent's with the joint at 0.
  world::Pose add_joint(const BodyEntry& body, const JointEntry& entry, const std::string& above,
                        const std::string& below, const world::Pose& X_PB) {
    RobotJoint joint;
    joint.joint.name = entry.name;
    joint.line = entry.element->line;
    joint.file = file_of(*entry.element);
    joint.parent = above;
    joint.child = below;
    world::Joint& j = joint.joint;
    j.axis_J = entry.axis_B;
    j.X_CJ = at(entry.anchor_B);
    world::Pose back;  // from the pose of the file to position 0
    if (entry.type == JointType::kHinge) back.q = turn_about(entry.axis_B, -entry.reference);
    if (entry.type == JointType::kSlide) back.p = -entry.reference * entry.axis_B;
    if (entry.type == JointType::kBall) back.q = entry.turned;
    j.X_PJ = X_PB * at(entry.anchor_B) * back;
    if (keep_errors([&] { read_law(body, entry, joint); })) {
      reading_.model.joints.push_back(joint);
      keep_errors([&] { add_spring(entry, joint); });
    }
    return j.X_PJ * j.X_CJ.inverse();
  }

  template <typename Read>
  bool keep_errors(const Read& read) {
    const std::size_t before = reading_.errors.size();
    keep_error(reading_.errors, read);
    return reading_.errors.size() == before;
  }

  void read_law(const BodyEntry&, const JointEntry& entry, RobotJoint& joint) {
    const Values values = reading_.defaults.of(*entry.element, entry.class_name);
    world::Joint& j = joint.joint;
    const auto lose = [&](const char* what) {
      reading_.losses.add(std::string(what) + " is not simulated", *entry.element);
    };
    const auto least = [&](std::string_view attribute) {
      const auto all = values.numbers(attribute, 1, 3).value_or(std::vector<double>{0.0});
      if (all[0] < 0) values.fail(attribute, std::string(attribute) + " must be at least 0");
      return all[0];
    };
    if (values.number_or("armature", 0.0) != 0.0) lose("armature");
    const double damping = least("damping"), friction = least("frictionloss");
    if (entry.type == JointType::kBall) {
      j.kind = JointKind::kBall;
      if (damping > 0) lose("damping of a ball joint");
      if (friction > 0) lose("friction of a ball joint");
      if (least("stiffness") > 0) lose("the spring of a ball joint");
      if (is_limited(values)) lose("the range of a ball joint");
      return;
    }
    j.kind = entry.type == JointType::kHinge ? JointKind::kHinge : JointKind::kSlider;
    if (std::max(damping, friction) > kMaxLoss)
      reading_.repairs.add("damping and frictionloss count as 1e6 at most", *entry.element);
    j.damping = std::min(damping, kMaxLoss);
    j.friction = std::min(friction, kMaxLoss);
    read_range(values, entry, j);
    joint.initial = j.limited ? std::clamp(entry.initial, j.lower, j.upper) : entry.initial;
    if (values.text("springdamper")) lose("springdamper");
  }

  bool is_limited(const Values& values) const {
    const bool given = values.text("range") != nullptr;
    return values.flag("limited").value_or(reading_.settings.auto_limits && given);
  }

  void read_range(const Values& values, const JointEntry& entry, world::Joint& j) const {
    j.limited = is_limited(values);
    if (!j.limited) return;
    const auto range = values.numbers("range", 2, 2);
    if (!range) entry.element->fail("is limited, and has no range");
    const double unit = entry.type == JointType::kHinge ? reading_.settings.radians_per_angle : 1.0;
    j.lower = std::clamp((*range)[0] * unit, -kMaxPosition, kMaxPosition);
    j.upper = std::clamp((*range)[1] * unit, -kMaxPosition, kMaxPosition);
    if (j.lower > j.upper) values.fail("range", "the lower limit is above the upper one");
  }

  // A spring stands beside its joint: about a hinge's axis, or from far away to a slide's place.
  void add_spring(const JointEntry& entry, const RobotJoint& beside) {
    if (entry.type == JointType::kBall) return;
    const Values values = reading_.defaults.of(*entry.element, entry.class_name);
    const double stiffness = values.numbers("stiffness", 1, 3).value_or(std::vector<double>{0.0})[0];
    if (stiffness <= 0) return;
    RobotJoint spring = beside;
    world::Joint& j = spring.joint;
    j.name += "_spring";
    j.limited = false;
    j.friction = j.damping = 0.0;
    j.stiffness = stiffness;
    const bool hinge = entry.type == JointType::kHinge;
    const double rest =
        values.number_or("springref", 0.0) * (hinge ? reading_.settings.radians_per_angle : 1.0);
    if (std::abs(rest) > kSpringLengthM / 2) values.fail("springref", "springref is too large");
    j.kind = hinge ? JointKind::kTorsionSpring : JointKind::kSpring;
    j.rest = hinge ? rest : kSpringLengthM + rest;
    if (!hinge) j.X_PJ.p -= j.X_PJ.q * (kSpringLengthM * j.axis_J);
    spring.initial = 0.0;
    reading_.model.joints.push_back(std::move(spring));
  }

  Reading& reading_;
  const std::vector<BodyEntry>& bodies_;
  std::vector<world::Pose> X_MB_;             // with all joints at 0
  std::vector<MassProperties> group_masses_;  // roughly: as if the frames of fixed bodies were one
};

}  // namespace

std::string link_of(const std::vector<BodyEntry>& bodies, std::size_t body) {
  return body == 0 ? kWorldLink : bodies[body].name;
}

void add_links(Reading& reading, const std::vector<BodyEntry>& bodies) {
  LinkMaker(reading, bodies).make();
}

}  // namespace visum::scene::mjcf

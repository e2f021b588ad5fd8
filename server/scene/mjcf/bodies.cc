#include "server/scene/mjcf/bodies.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "protocol/config/unknown_name.h"
#include "server/scene/model_errors.h"

namespace visum::scene::mjcf {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

class TreeReader {
 public:
  explicit TreeReader(Reading& reading) : reading_(reading) {}

  std::vector<BodyEntry> read() {
    bodies_.push_back({});
    bodies_[0].name = kWorldLink;
    bodies_[0].element = &reading_.root;
    bool found = false;
    each_child(reading_.root, "worldbody", [&](const Element& world) {
      found = true;
      read_children(world, 0, {}, class_of(world, ""));
    });
    if (!found) reading_.losses.add("has no <worldbody>, so it has no bodies", reading_.root);
    settle_names();
    find_groups();
    scale_masses();
    return std::move(bodies_);
  }

 private:
  void keep(const std::function<void()>& read) {
    if (reading_.errors.size() < kMaxErrors) keep_error(reading_.errors, read);
  }

  std::string class_of(const Element& element, const std::string& outer) const {
    const std::string* own = element.attribute("childclass");
    if (own) reading_.defaults.demand(element, *own);
    return own ? *own : outer;
  }

  // `X_BF`: the frame that the children count from, in body number `body`.
  void read_children(const Element& element, std::size_t body, const world::Pose& X_BF,
                     const std::string& class_name) {
    for (const Element& child : element.children) keep([&] { read_child(child, body, X_BF, class_name); });
  }

  void read_child(const Element& child, std::size_t body, const world::Pose& X_BF,
                  const std::string& class_name) {
    if (child.tag == "body") return read_body(child, body, X_BF, class_name);
    if (child.tag == "geom")
      return bodies_[body].geoms.push_back(read_geom(reading_, child, class_name, X_BF, needs_geoms(body)));
    if (child.tag == "joint" || child.tag == "freejoint") return read_joint(child, body, X_BF, class_name);
    if (child.tag == "frame") {
      const world::Pose X_FF = read_pose(Values(child, {}), reading_.settings);
      return read_children(child, body, X_BF * X_FF, class_of(child, class_name));
    }
    if (child.tag == "inertial" || child.tag == "site") return;
    reading_.losses.add("<" + child.tag + "> is not read", child);
  }

  void read_body(const Element& element, std::size_t parent, const world::Pose& X_PF,
                 const std::string& outer_class) {
    if (bodies_.size() > kMaxBodies)
      element.fail("there are more than " + std::to_string(kMaxBodies) + " bodies");
    const Values values(element, {});
    BodyEntry body{};
    body.element = &element;
    body.name = element.name();
    body.parent = parent;
    body.X_PB = X_PF * read_pose(values, reading_.settings);
    body.mocap = values.flag("mocap").value_or(false);
    if (body.mocap) reading_.losses.add("mocap bodies stand still", element);
    if (values.number_or("gravcomp", 0.0) != 0.0)
      reading_.losses.add("compensation of gravity is not simulated", element);
    const std::size_t index = bodies_.size();
    bodies_.push_back(std::move(body));
    read_children(element, index, {}, class_of(element, outer_class));
    keep([&] { set_mass(bodies_[index]); });
  }

  bool needs_geoms(std::size_t body) const {
    if (body == 0) return false;
    if (reading_.settings.inertia_from_geoms) return *reading_.settings.inertia_from_geoms;
    return inertial_of(*bodies_[body].element) == nullptr;
  }

  static const Element* inertial_of(const Element& body) {
    const Element* found = nullptr;
    each_child(body, "inertial", [&](const Element& inertial) { found = &inertial; });
    return found;
  }

  static JointType joint_type(const Values& values, const std::string& type) {
    if (type == "hinge") return JointType::kHinge;
    if (type == "slide") return JointType::kSlide;
    if (type == "ball") return JointType::kBall;
    values.fail("type", "there is no type '" + type.substr(0, 60) + "' of joints");
  }

  void read_joint(const Element& element, std::size_t index, const world::Pose& X_BF,
                  const std::string& class_name) {
    BodyEntry& body = bodies_[index];
    if (index == 0) element.fail("the world has no joints");
    JointEntry joint;
    joint.element = &element;
    joint.class_name = class_name;
    const Values values = reading_.defaults.of(element, class_name);
    const std::string type = element.tag == "freejoint" ? "free" : values.text_or("type", "hinge");
    if (body.free || (type == "free" && !body.joints.empty())) element.fail("a free joint stands alone");
    if (type == "free") {
      if (body.parent != 0) element.fail("a free joint belongs to a body of the world");
      body.free = true;
      return;
    }
    joint.name = element.name();
    joint.type = joint_type(values, type);
    if (const auto p = values.numbers("pos", 3, 3)) joint.anchor_B = {(*p)[0], (*p)[1], (*p)[2]};
    if (const auto a = values.numbers("axis", 3, 3)) joint.axis_B = {(*a)[0], (*a)[1], (*a)[2]};
    if (joint.type != JointType::kBall && joint.axis_B.norm() < 1e-10)
      values.fail("axis", "axis must not be zero");
    if (joint.type == JointType::kBall) joint.axis_B = Vector3d::UnitZ();
    joint.anchor_B = X_BF * joint.anchor_B;
    joint.axis_B = X_BF.q * joint.axis_B.normalized();
    const double unit = joint.type == JointType::kHinge ? reading_.settings.radians_per_angle : 1.0;
    if (joint.type != JointType::kBall) joint.reference = values.number_or("ref", 0.0) * unit;
    if (std::abs(joint.reference) > 1e5) values.fail("ref", "ref is beyond 1e5");
    joint.initial = joint.reference;
    body.joints.push_back(std::move(joint));
  }

  void set_mass(BodyEntry& body) {
    const Element* inertial = inertial_of(*body.element);
    const auto from_geoms = reading_.settings.inertia_from_geoms;
    if (inertial != nullptr && !from_geoms.value_or(false))
      body.mass = read_inertial(*inertial);
    else
      for (const Geom& geom : body.geoms) body.mass = together(body.mass, geom.mass);
    const Settings& settings = reading_.settings;
    const bool has_least = settings.least_mass > 0 || settings.least_inertia > 0;
    if (!has_least && (!settings.balance_inertia || body.mass.mass_kg <= 0)) return;
    body.mass.mass_kg = std::max(body.mass.mass_kg, settings.least_mass);
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(body.mass.inertia_C);
    Vector3d m = solver.eigenvalues().cwiseMax(settings.least_inertia);  // ascending
    if (settings.balance_inertia && m[0] + m[1] < m[2]) m.setConstant(m.mean());
    body.mass.inertia_C = solver.eigenvectors() * m.asDiagonal() * solver.eigenvectors().transpose();
  }

  MassProperties read_inertial(const Element& element) const {
    const Values values(element, {});
    if (!element.attribute("mass")) element.fail("<inertial> needs 'mass'");
    const double mass = values.number_or("mass", 0.0);
    if (mass < 0) element.fail("mass must be at least 0");
    const world::Pose X_BI = read_pose(values, reading_.settings);
    Matrix3d inertia = Matrix3d::Zero();
    if (const auto d = values.numbers("diaginertia", 3, 3)) inertia.diagonal() << (*d)[0], (*d)[1], (*d)[2];
    if (const auto f = values.numbers("fullinertia", 6, 6))
      inertia << (*f)[0], (*f)[3], (*f)[4], (*f)[3], (*f)[1], (*f)[5], (*f)[4], (*f)[5], (*f)[2];
    return moved({mass, Vector3d::Zero(), inertia}, X_BI);
  }

  // Gives names to what has none, and other ones to what has another's name.
  void settle_names() {
    std::set<std::string> bodies{kWorldLink, kWorldGeoms}, joints;
    for (const BodyEntry& body : bodies_) {
      bodies.insert(body.name);
      for (const JointEntry& joint : body.joints) joints.insert(joint.name);
    }
    std::set<std::string> used{kWorldLink, kWorldGeoms}, used_joints;
    for (std::size_t i = 1; i < bodies_.size(); ++i) {
      BodyEntry& body = bodies_[i];
      if (!body.name.empty() && !used.insert(body.name).second) clash(*body.element);
      if (body.name.empty()) body.name = unused("body_" + std::to_string(i), bodies);
      for (std::size_t k = 0; k < body.joints.size(); ++k) {
        JointEntry& joint = body.joints[k];
        if (!joint.name.empty() && !used_joints.insert(joint.name).second) clash(*joint.element);
        const std::string number = body.joints.size() > 1 ? "_" + std::to_string(k + 1) : "";
        if (joint.name.empty()) joint.name = unused(body.name + "_joint" + number, joints);
      }
    }
  }

  void clash(const Element& element) {
    keep([&] { element.fail("there is another " + element.tag + " of this name"); });
  }

  static std::string unused(std::string name, std::set<std::string>& taken) {
    while (!taken.insert(name).second) name += "_";
    return name;
  }

  void find_groups() {
    for (std::size_t i = 1; i < bodies_.size(); ++i) {
      BodyEntry& body = bodies_[i];
      const bool jointed = body.free || !body.joints.empty();
      if (body.mocap && jointed) keep([&] { body.element->fail("a mocap body has no joints"); });
      body.moves = jointed || bodies_[body.parent].moves;
      body.group = jointed || body.parent == 0 ? i : bodies_[body.parent].group;
    }
  }

  void scale_masses() {
    double sum = 0.0;
    for (const BodyEntry& body : bodies_) sum += body.mass.mass_kg;
    if (reading_.settings.total_mass <= 0 || sum <= 0) return;
    for (BodyEntry& body : bodies_) body.mass = scaled(body.mass, reading_.settings.total_mass / sum);
  }

  Reading& reading_;
  std::vector<BodyEntry> bodies_;
};

}  // namespace

std::vector<BodyEntry> read_bodies(Reading& reading) {
  return TreeReader(reading).read();
}

std::size_t find_body(const std::vector<BodyEntry>& bodies, const std::string& name, const Element& user) {
  std::vector<std::string> known;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (bodies[i].name == name) return i;
    known.push_back(bodies[i].name);
  }
  user.fail(config::unknown_name("body", name, known));
}

}  // namespace visum::scene::mjcf

#include "server/scene/convert/write_sdf.h"

#include <tinyxml2.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "server/scene/convert/pairs.h"
#include "server/world/joint_kinds.h"

namespace visum::scene {
namespace {

using world::JointKind;
using world::ShapeKind;

// An SDF pose: position, then roll, pitch and yaw.
std::string pose_text(const world::Pose& pose) {
  const Eigen::Matrix3d r = pose.q.toRotationMatrix();
  const double pitch = std::atan2(-r(2, 0), std::hypot(r(0, 0), r(1, 0)));
  const bool upright = std::hypot(r(0, 0), r(1, 0)) > 1e-12;
  const double roll = upright ? std::atan2(r(2, 1), r(2, 2)) : std::atan2(-r(1, 2), r(1, 1));
  const double yaw = upright ? std::atan2(r(1, 0), r(0, 0)) : 0.0;
  const double all[] = {pose.p.x(), pose.p.y(), pose.p.z(), roll, pitch, yaw};
  return exact(all, 6);
}

// Null: SDF has no such joint.
const char* sdf_type(const world::Joint& joint) {
  switch (joint.kind) {
    case JointKind::kFixed:
      return "fixed";
    case JointKind::kHinge:
      return "revolute";
    case JointKind::kSlider:
      return "prismatic";
    case JointKind::kBall:
      return "ball";
    case JointKind::kUniversal:
      return "universal";
    case JointKind::kScrew:
      return "screw";
    default:
      return nullptr;
  }
}

// A name that SDF allows: without scopes, and not "world".
std::string flat(std::string name) {
  for (std::size_t at = name.find("::"); at != std::string::npos; at = name.find("::"))
    name.replace(at, 2, ".");
  std::ranges::replace(name, '/', '.');
  return name == "world" ? "world_" : name;
}

bool same_place(const world::Pose& a, const world::Pose& b) {
  return (a.p - b.p).norm() < 1e-12 && a.q.angularDistance(b.q) < 1e-12;
}

// Writes a scene as the elements of one SDF document, in their order. Poses are in the world.
class SdfWriter {
 public:
  SdfWriter(const Scene& scene, Output& output)
      : scene_(scene),
        world_(scene.world),
        output_(output),
        untold_(pairs_beside_joints(world_, [](const auto& joint) { return sdf_type(joint) != nullptr; })) {}

  std::string text() {
    out_.PushHeader(false, true);
    open("sdf", "version", "1.9");
    open("world", "name", scene_.name.c_str());
    physics();
    for (const Light& light : scene_.looks.lights) add_light(light);
    for (const auto& [first, members] : groups()) model(first, members);
    close();
    close();
    tell_losses();
    return out_.CStr();
  }

 private:
  void open(const char* name) { out_.OpenElement(name); }
  void open(const char* name, const char* attribute, const char* value) {
    open(name);
    out_.PushAttribute(attribute, value);
  }
  void close() { out_.CloseElement(); }
  void element(const char* name, const std::string& text) {
    open(name);
    out_.PushText(text.c_str());
    close();
  }
  void element(const char* name, double number) { element(name, exact(number)); }
  void element(const char* name, const Eigen::Vector3d& vector) { element(name, exact(vector.data(), 3)); }

  void physics() {
    const double tick_s = static_cast<double>(world_.tick_ns) * 1e-9;
    element("gravity", world_.gravity);
    open("physics");
    out_.PushAttribute("name", "tick");
    out_.PushAttribute("type", "ode");
    element("max_step_size", tick_s);
    element("real_time_factor", scene_.speed);
    close();
  }

  // Groups bodies that joints connect or that belong to one model, under the first of them.
  std::map<std::size_t, std::vector<std::size_t>> groups() const {
    std::vector<std::size_t> leader(world_.bodies.size());
    for (std::size_t i = 0; i < leader.size(); ++i) leader[i] = i;
    const auto find = [&](std::size_t i) {
      while (leader[i] != i) i = leader[i];
      return i;
    };
    for (const auto& joint : world_.joints) {
      if (!joint.parent.valid() || !sdf_type(joint)) continue;
      const std::size_t a = find(joint.parent.index()), b = find(joint.child.index());
      leader[std::max(a, b)] = std::min(a, b);
    }
    std::map<std::string, std::size_t> first_of;
    for (std::size_t i = 0; i < leader.size(); ++i) {
      const std::string& model = world_.bodies[i].model;
      if (model.empty()) continue;
      const std::size_t a = find(first_of.emplace(model, i).first->second), b = find(i);
      leader[std::max(a, b)] = std::min(a, b);
    }
    std::map<std::size_t, std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < leader.size(); ++i) groups[find(i)].push_back(i);
    return groups;
  }

  // The name of a body or joint within its SDF model: "link_1" for "arm/link_1", if all of it is the arm.
  std::string inner_name(const std::string& name) const {
    const std::string prefix = scope_ + "/";
    return flat(!scope_.empty() && name.starts_with(prefix) ? name.substr(prefix.size()) : name);
  }
  std::string link_name(const world::Body& body) const { return inner_name(body.name); }

  std::string unique_model(const std::string& wanted) {
    std::string name = wanted;
    for (int i = 2; !models_.insert(name).second; ++i) name = wanted + "_" + std::to_string(i);
    return name;
  }

  // A model of the bodies `members`, with the joints that carry them. It has the name of the scene's model
  // that they all belong to, else that of its first body.
  void model(std::size_t first, const std::vector<std::size_t>& members) {
    scope_ = world_.bodies[first].model;
    if (!std::ranges::all_of(members, [&](std::size_t i) { return world_.bodies[i].model == scope_; }))
      scope_.clear();
    open("model", "name", unique_model(flat(scope_.empty() ? world_.bodies[first].name : scope_)).c_str());
    const bool fixed = std::ranges::all_of(members, [&](std::size_t i) { return world_.bodies[i].fixed; });
    if (fixed) element("static", "true");
    if (members.size() > 1) self_collide(members);
    for (const std::size_t i : members) link(world::BodyId{static_cast<std::int32_t>(i)});
    for (const auto& joint : world_.joints)
      if (std::ranges::find(members, joint.child.index()) != members.end()) add_joint(joint);
    if (!fixed)
      for (const std::size_t i : members)
        if (world_.bodies[i].fixed) hold(world_.bodies[i]);
    close();
  }

  // SDF keeps all links of a model apart from each other, or only those that a joint connects.
  void self_collide(const std::vector<std::size_t>& members) {
    const auto within = [&](const auto& pair) {
      return std::ranges::binary_search(members, pair.first.index()) &&
             std::ranges::binary_search(members, pair.second.index());
    };
    const auto apart = static_cast<std::size_t>(std::ranges::count_if(world_.no_collision, within));
    if (apart == members.size() * (members.size() - 1) / 2)
      std::erase_if(untold_, within);
    else
      element("self_collide", std::string("true"));
  }

  // Fixes a link that stands still among others that move.
  void hold(const world::Body& body) {
    open("joint");
    out_.PushAttribute("name", (link_name(body) + "_stands").c_str());
    out_.PushAttribute("type", "fixed");
    element("parent", std::string("world"));
    element("child", link_name(body));
    close();
  }

  void link(world::BodyId id) {
    const world::Body& body = world_.bodies[id.index()];
    open("link", "name", link_name(body).c_str());
    element("pose", pose_text(body.X_WB));
    if (body.kinematic) element("kinematic", std::string("true"));
    if (!body.fixed && !body.kinematic) inertial(body);
    std::size_t number = 0;
    for (const auto& shape : world_.shapes)
      if (shape.body == id) add_shape(shape, number++);
    close();
    if (body.v_WB != Eigen::Vector3d::Zero() || body.w_WB != Eigen::Vector3d::Zero())
      output_.lose("SDF has no initial velocities: '" + body.name + "' starts at rest");
  }

  void inertial(const world::Body& body) {
    open("inertial");
    element("pose", pose_text({body.p_BC, Eigen::Quaterniond::Identity()}));
    element("mass", body.mass_kg);
    open("inertia");
    constexpr const char* kNames[3][3] = {{"ixx", "ixy", "ixz"}, {"", "iyy", "iyz"}, {"", "", "izz"}};
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j) element(kNames[i][j], body.inertia_C(i, j));
    close();
    close();
  }

  void add_shape(const world::Shape& shape, std::size_t number) {
    const std::string name = shape.name + "_" + std::to_string(number);
    if (shape.collides) {
      open("collision", "name", name.c_str());
      element("pose", pose_text(shape.X_BS));
      geometry(shape);
      surface(world_.surfaces[shape.surface.index()]);
      close();
    }
    if (shape.color[3] == 0.0) return;
    open("visual", "name", (name + "_look").c_str());
    element("pose", pose_text(shape.X_BS));
    geometry(shape);
    open("material");
    // Opaque: a reader multiplies alpha by what <transparency> leaves.
    element("diffuse", exact(shape.color.data(), 3) + " 1");
    element("ambient", exact(shape.color.data(), 3) + " 1");
    close();
    element("transparency", 1.0 - shape.color[3]);
    close();
    if (shape.material >= 0) output_.lose("materials are written to SDF as their colours alone");
  }

  void geometry(const world::Shape& shape) {
    open("geometry");
    switch (shape.kind) {
      case ShapeKind::kBox:
        open("box");
        element("size", exact(shape.size.data(), 3));
        break;
      case ShapeKind::kSphere:
        open("sphere");
        element("radius", shape.size[0]);
        break;
      case ShapeKind::kCylinder:
      case ShapeKind::kCapsule:
        open(shape.kind == ShapeKind::kCylinder ? "cylinder" : "capsule");
        element("radius", shape.size[0]);
        element("length", shape.size[1]);
        break;
      case ShapeKind::kPlane:
        open("plane");
        element("normal", std::string("0 0 1"));
        element("size", std::string("200 200"));
        break;
      case ShapeKind::kConvex:
        output_.lose("SDF has no convex hulls: '" + shape.name + "' is written as its whole mesh");
        [[fallthrough]];
      case ShapeKind::kMesh:
        open("mesh");
        element("uri", output_.add_mesh(world_.meshes[shape.mesh.index()]));
    }
    close();
    close();
  }

  void surface(const world::Surface& surface) {
    open("surface");
    open("friction");
    open("ode");
    element("mu", surface.friction);
    element("mu2", surface.friction);
    close();
    close();
    open("bounce");
    element("restitution_coefficient", surface.restitution);
    close();
    close();
    if (surface.rolling_friction > 0.0 || surface.torsional_friction > 0.0)
      output_.lose("rolling and torsional friction of surface '" + surface.name + "' are not written to SDF");
  }

  // The spring beside a hinge, which SDF writes as a part of it.
  const world::Joint* spring_of(const world::Joint& hinge) const {
    if (hinge.kind != JointKind::kHinge) return nullptr;
    const auto found = std::ranges::find_if(world_.joints, [&](const world::Joint& other) {
      return other.kind == JointKind::kTorsionSpring && other.parent == hinge.parent &&
             other.child == hinge.child && other.damping == 0.0 &&
             (other.axis_J - hinge.axis_J).norm() < 1e-12 && same_place(other.X_PJ, hinge.X_PJ);
    });
    return found == world_.joints.end() ? nullptr : &*found;
  }

  bool is_written_as_spring(const world::Joint& spring) const {
    return std::ranges::any_of(world_.joints,
                               [&](const world::Joint& hinge) { return spring_of(hinge) == &spring; });
  }

  void add_joint(const world::Joint& joint) {
    const char* type = sdf_type(joint);
    if (!type && is_written_as_spring(joint)) return;
    if (!type) {
      output_.lose("SDF has no joint of type " + std::string(world::info(joint.kind).name) + ": '" +
                   joint.name + "' is left out");
      return;
    }
    open("joint");
    out_.PushAttribute("name", inner_name(joint.name).c_str());
    out_.PushAttribute("type", type);
    element("parent", joint.parent.valid() ? link_name(world_.bodies[joint.parent.index()]) : "world");
    element("child", link_name(world_.bodies[joint.child.index()]));
    element("pose", pose_text(joint.X_CJ));
    if (joint.kind == JointKind::kScrew) element("screw_thread_pitch", joint.pitch_m);
    const bool turns = joint.kind == JointKind::kUniversal || world::is_drivable(joint.kind);
    if (turns) axis("axis", joint, joint.axis_J);
    if (joint.kind == JointKind::kUniversal) axis("axis2", joint, joint.axis2_J);
    close();
    if (joint.initial_position != 0.0)
      output_.lose("SDF has no initial positions: joint '" + joint.name + "' starts at 0");
    if (joint.limited && joint.stop_restitution > 0.0)
      output_.lose("the restitution of the stops of joint '" + joint.name + "' is not written to SDF");
  }

  void axis(const char* name, const world::Joint& joint, const Eigen::Vector3d& direction) {
    open(name);
    element("xyz", direction);
    if (joint.limited) {
      open("limit");
      element("lower", joint.lower);
      element("upper", joint.upper);
      close();
    }
    open("dynamics");
    element("damping", joint.damping);
    element("friction", joint.friction);
    if (const world::Joint* spring = spring_of(joint)) {
      element("spring_stiffness", spring->stiffness);
      element("spring_reference", spring->rest);
    }
    close();
    close();
  }

  void add_light(const Light& light) {
    if (light.kind == LightKind::kAmbient) return output_.lose("SDF has no ambient lights among its lights");
    const char* type = light.kind == LightKind::kDirectional ? "directional"
                       : light.kind == LightKind::kSpot      ? "spot"
                                                             : "point";
    open("light");
    out_.PushAttribute(
        "name", light.name.empty() ? ("light_" + std::to_string(lights_)).c_str() : light.name.c_str());
    out_.PushAttribute("type", type);
    ++lights_;
    element("pose", pose_text({light.position, Eigen::Quaterniond::Identity()}));
    element("diffuse", exact(light.color.data(), 4));
    element("intensity", light.intensity);
    if (light.kind != LightKind::kPoint) element("direction", light.direction);
    if (light.kind == LightKind::kSpot) {
      open("spot");
      element("inner_angle", light.angle_rad);
      element("outer_angle", light.angle_rad);
      element("falloff", 0.0);
      close();
    }
    element("cast_shadows", std::string(light.shadows ? "true" : "false"));
    close();
  }

  // Notes the pairs that never collide in the scene, but can in the SDF file.
  void tell_pairs() {
    if (untold_.empty()) return;
    const auto name = [&](world::BodyId id) { return "'" + world_.bodies[id.index()].name + "'"; };
    const std::size_t others = untold_.size() - 1;
    output_.lose("SDF cannot keep pairs of bodies apart: " + name(untold_[0].first) + " and " +
                 name(untold_[0].second) + (others > 0 ? " (and " + std::to_string(others) + " more)" : "") +
                 " can collide there");
  }

  void tell_losses() {
    tell_pairs();
    for (const auto& follower : scene_.followers)
      output_.lose("joint '" + scene_.world.joints[follower.joint.index()].name +
                   "' is written without the joint that it follows");
    for (const auto& part : scene_.parts)
      output_.lose("SDF has no hardware parts: '" + part.context.name + "' is left out");
    for (const auto& sensor : scene_.sensors)
      output_.lose("sensor '" + sensor.name + "' is not written to SDF");
    for (const auto& agent : scene_.agents)
      output_.lose("SDF has no agents: '" + agent.name + "' is left out");
    if (!scene_.looks.viewpoints.empty()) output_.lose("SDF has no viewpoints");
    if (!scene_.looks.panels.empty()) output_.lose("SDF has no panels");
    for (const auto& engine : world_.engines)
      if (engine.name != "ode" && engine.name != "impulse")
        output_.lose("SDF has no engine '" + engine.name + "'");
  }

  const Scene& scene_;
  const world::WorldModel& world_;
  Output& output_;
  std::vector<std::pair<world::BodyId, world::BodyId>> untold_;  // pairs that the SDF file cannot keep apart
  tinyxml2::XMLPrinter out_;
  std::size_t lights_ = 0;
  std::string scope_;             // the scene's model that all of the SDF model belongs to; empty: several
  std::set<std::string> models_;  // names of SDF models
};

}  // namespace

std::string to_sdf(const Scene& scene, Output& output) {
  return SdfWriter(scene, output).text();
}

}  // namespace visum::scene

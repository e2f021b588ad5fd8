#include "server/scene/sdf_robot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <string_view>
#include <type_traits>

#include "protocol/config/number_text.h"
#include "protocol/config/unknown_name.h"
#include "server/scene/ellipsoid.h"
#include "server/scene/inertia_repair.h"
#include "server/scene/model_errors.h"
#include "server/scene/sdf_expand.h"
#include "server/scene/sdf_frames.h"
#include "server/scene/sdf_include.h"
#include "server/scene/shape_intake.h"

namespace visum::scene {
namespace {

constexpr double kUnlimited = 1e6;  // files write 1e16 or infinity for "no limit"

std::string name_of(const XMLElement& element) {
  const char* name = element.Attribute("name");
  return name ? name : "";
}

// The numbers of a child, which check_sdf_text() has checked. Nothing where there is no such child.
std::optional<std::vector<double>> numbers_of(const XMLElement* parent, const char* tag) {
  const XMLElement* child = parent ? parent->FirstChildElement(tag) : nullptr;
  return child ? text_numbers(*child) : std::nullopt;
}

// One number, which may be infinite.
double number_or(const XMLElement* parent, const char* tag, double otherwise) {
  const XMLElement* child = parent ? parent->FirstChildElement(tag) : nullptr;
  double number = otherwise;
  if (child != nullptr && child->GetText() != nullptr) child->QueryDoubleText(&number);
  return number;
}

std::optional<Eigen::Vector3d> vector_of(const XMLElement* parent, const char* tag) {
  const auto numbers = numbers_of(parent, tag);
  if (!numbers || numbers->size() != 3) return std::nullopt;
  return Eigen::Vector3d((*numbers)[0], (*numbers)[1], (*numbers)[2]);
}

class SdfReader {
 public:
  SdfReader(RobotModel& model, const ModelXml& xml, const Packages& packages)
      : model_(model), xml_(xml), shapes_(model, packages), file_(model.file.string()) {}

  void read(const XMLElement& top) {
    SdfFrames frames(top, file_);
    std::vector<MeshAddress> meshes;
    find_meshes(top, "", meshes);
    shapes_.convert_ahead(meshes);
    read_model(top, frames, "", {}, false);
    throw_all(std::move(errors_));
    sort_as_in_file();
  }

 private:
  static constexpr std::array<const char*, 2> kShapes{"collision", "visual"};
  static const XMLElement& form_of(const XMLElement& shape) {
    return *shape.FirstChildElement("geometry")->FirstChildElement();
  }
  // Null for a visual, and for a collision that says nothing of it.
  const ModelSurface* surface_of(const XMLElement& shape, const std::string& link) const {
    if (std::strcmp(shape.Name(), "collision")) return nullptr;
    const auto known = xml_.surfaces.find({link, name_of(shape)});
    return known == xml_.surfaces.end() ? nullptr : &known->second;
  }

  // Those of a model and of the models in it. `prefix`: of its links' names.
  void find_meshes(const XMLElement& model, const std::string& prefix,
                   std::vector<MeshAddress>& found) const {
    for (auto link = model.FirstChildElement("link"); link; link = link->NextSiblingElement("link")) {
      const std::string name = prefix + name_of(*link);
      for (const char* tag : kShapes)
        for (auto shape = link->FirstChildElement(tag); shape; shape = shape->NextSiblingElement(tag)) {
          const ModelSurface* surface = surface_of(*shape, name);
          const XMLElement& form = form_of(*shape);
          const bool is_mesh = !std::strcmp(form.Name(), "mesh") && not_simulated(form).empty();
          if (is_mesh && (!surface || surface->collides))
            found.push_back({text_of(form.FirstChildElement("uri")), file_of(name)});
        }
    }
    for (auto inner = model.FirstChildElement("model"); inner; inner = inner->NextSiblingElement("model"))
      find_meshes(*inner, prefix + name_of(*inner) + "::", found);
  }

  static int line_of(const std::map<std::string, int>& lines, const std::string& name) {
    const auto found = lines.find(name);
    return found == lines.end() ? 0 : found->second;
  }
  config::Place joint_place(const std::string& joint) const {
    return {file_of(joint), line_of(xml_.joint_lines, joint), "joint '" + joint + "'"};
  }
  // The file in which a link or joint stands.
  std::string file_of(const std::string& name) const {
    const auto other = xml_.files.find(name);
    return other == xml_.files.end() ? file_ : other->second;
  }
  std::string other_file(const std::string& name) const {
    const std::string file = file_of(name);
    return file == file_ ? "" : file;
  }

  // X_TM: the pose of this model in the top one. Models nested in a static model are static, too.
  void read_model(const XMLElement& model, SdfFrames& frames, const std::string& prefix,
                  const world::Pose& X_TM, bool is_static) {
    is_static = is_static || is_true(model.FirstChildElement("static"));
    const XMLElement* collides = model.FirstChildElement("self_collide");
    for (auto link = model.FirstChildElement("link"); link; link = link->NextSiblingElement("link")) {
      read_link(*link, frames, prefix, X_TM, is_static);
      const XMLElement* own = link->FirstChildElement("self_collide");
      model_.links.back().self_collides = is_true(own ? own : collides);
    }
    for (auto joint = model.FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint"))
      keep_error(errors_, [&] { read_joint(*joint, frames, prefix, X_TM); });
    for (auto inner = model.FirstChildElement("model"); inner; inner = inner->NextSiblingElement("model")) {
      const std::string name = name_of(*inner);
      read_model(*inner, frames.inner(name), prefix + name + "::", X_TM * frames.pose(name, *inner),
                 is_static);
    }
  }

  void read_link(const XMLElement& from, SdfFrames& frames, const std::string& prefix,
                 const world::Pose& X_TM, bool is_static) {
    RobotLink link;
    const std::string own = name_of(from);
    link.name = prefix + own;
    link.line = line_of(xml_.link_lines, link.name);
    link.file = other_file(link.name);
    const world::Pose X_ML = frames.pose(own, from);
    link.X_ML = X_TM * X_ML;
    link.on_ground = is_static;
    if (xml_.massless.count(link.name) == 0) link.mass = read_mass(from);
    if (xml_.without_inertia.count(link.name) != 0) link.mass.inertia_C.setZero();
    for (const char* tag : kShapes)
      for (auto shape = from.FirstChildElement(tag); shape; shape = shape->NextSiblingElement(tag))
        keep_error(errors_, [&] { read_shape(*shape, frames, own, X_ML, link); });
    match_visuals(link);
    model_.links.push_back(std::move(link));
  }

  // By SDF, a link has 1 kg and 1 kg·m² about each axis where it does not say otherwise.
  MassProperties read_mass(const XMLElement& link) const {
    const XMLElement* inertial = link.FirstChildElement("inertial");
    const XMLElement* inertia = inertial ? inertial->FirstChildElement("inertia") : nullptr;
    Eigen::Matrix3d moments = Eigen::Matrix3d::Identity();
    for (std::size_t i = 0; i < kMoments.size(); ++i) {
      const auto [row, column] = kMomentPlaces[i];
      moments(row, column) = moments(column, row) =
          number_or(inertia, kMoments[i], row == column ? 1.0 : 0.0);
    }
    const MassProperties own{number_or(inertial, "mass", 1.0), Eigen::Vector3d::Zero(), moments};
    return inertial ? moved(own, raw_pose(*inertial, file_)) : own;
  }

  // `X_ML`: of its link, in its own model.
  void read_shape(const XMLElement& element, SdfFrames& frames, const std::string& own_link,
                  const world::Pose& X_ML, RobotLink& link) {
    RobotShape shape;
    shape.name = name_of(element);
    shape.link = link.name;
    shape.collides = !std::strcmp(element.Name(), "collision");
    if (const ModelSurface* surface = surface_of(element, link.name)) {
      shape.surface = *surface;
      if (!surface->collides) return;
    }
    shape.X_LS = X_ML.inverse() * frames.pose_of(element, own_link);
    double opacity = 1.0;
    if (!shape.collides) {
      opacity = std::clamp(1.0 - number_or(&element, "transparency", 0.0), 0.0, 1.0);
      if (const XMLElement* material = element.FirstChildElement("material"))
        shape.color = color_of(*material);
    }
    const XMLElement& form = form_of(element);
    if (const std::string fault = not_simulated(form); !fault.empty())
      return shapes_.leave_out(shape, fault, link);
    const std::string fault = read_geometry(form, link, shape);
    shapes_.add(std::move(shape), fault, opacity, link);
  }

  // Black where there is a material without a colour. Shares above 1 are of 255, as Gazebo takes them.
  static std::array<double, 4> color_of(const XMLElement& material) {
    std::array<double, 4> rgba{0.0, 0.0, 0.0, 1.0};
    const auto diffuse = numbers_of(&material, "diffuse");
    for (std::size_t i = 0; diffuse && i < std::min<std::size_t>(diffuse->size(), 4); ++i)
      rgba[i] = (*diffuse)[i] > 1.0 ? std::min((*diffuse)[i] / 255.0, 1.0) : (*diffuse)[i];
    return rgba;
  }

  // Says why a form is left out, even where it collides; empty: it is read.
  static std::string not_simulated(const XMLElement& form) {
    static constexpr std::array<std::string_view, 7> kForms{"box",       "sphere", "cylinder", "capsule",
                                                            "ellipsoid", "plane",  "mesh"};
    if (std::ranges::find(kForms, std::string_view(form.Name())) == kForms.end())
      return "has the form <" + std::string(form.Name()) +
             ">, which is not simulated (box, sphere, cylinder, capsule, ellipsoid, plane and mesh are)";
    if (form.FirstChildElement("submesh")) return "names a submesh, and only whole meshes are read";
    return "";
  }

  // Fills kind, size and mesh. If it cannot, returns the reason.
  std::string read_geometry(const XMLElement& form, const RobotLink& link, RobotShape& shape) {
    using world::ShapeKind;
    const std::string tag = form.Name();
    if (tag == "mesh") return read_mesh(form, link, shape);
    if (tag == "plane") {
      const auto sides = numbers_of(&form, "size").value_or(std::vector<double>{1.0, 1.0});
      const Eigen::Vector3d normal = vector_of(&form, "normal").value_or(Eigen::Vector3d::UnitZ());
      if (normal.norm() < 1e-9) return "has a <normal> of length zero";
      shape.kind = ShapeKind::kPlane;
      if (!shape.collides && sides.size() >= 2) shape.size = {sides[0], sides[1], 0};
      shape.X_LS.q = shape.X_LS.q * Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal);
      return "";
    }
    if (tag == "box") {
      const Eigen::Vector3d size = size_of(form, "size", Eigen::Vector3d(1.0, 1.0, 1.0), shape);
      shape.kind = ShapeKind::kBox;
      shape.size = {size.x(), size.y(), size.z()};
      return "";
    }
    if (tag == "ellipsoid") {
      set_ellipsoid(shape, size_of(form, "radii", Eigen::Vector3d(1.0, 1.0, 1.0), shape));
      return "";
    }
    shape.kind = tag == "sphere"     ? ShapeKind::kSphere
                 : tag == "cylinder" ? ShapeKind::kCylinder
                                     : ShapeKind::kCapsule;
    shape.size[0] = size_of(form, "radius", tag == "capsule" ? 0.5 : 1.0, shape);
    if (tag != "sphere") shape.size[1] = size_of(form, "length", 1.0, shape);
    return "";
  }

  // A size of a form, or SDF's default, which is noted.
  template <typename Size>
  Size size_of(const XMLElement& form, const char* tag, const Size& otherwise, const RobotShape& shape) {
    if constexpr (std::is_same_v<Size, double>) {
      if (form.FirstChildElement(tag)) return number_or(&form, tag, otherwise);
    } else {
      if (const auto size = vector_of(&form, tag)) return *size;
    }
    model_.losses.push_back(remark(form, "the shape '" + shape.name + "' of link '" + shape.link +
                                             "' gives no <" + tag + ">: SDF's default is used"));
    return otherwise;
  }

  // The hull of points on it. Its mesh stands among the converted ones, under a name that no file has.
  void set_ellipsoid(RobotShape& shape, const Eigen::Vector3d& radii) {
    shape.kind = world::ShapeKind::kConvex;
    shape.mesh = "ellipsoid";
    for (const double radius : radii) shape.mesh += " " + config::number_text(radius);
    ColladaMesh& mesh = model_.converted[shape.mesh];
    if (mesh.parts.empty()) mesh.parts.push_back({.mesh = ellipsoid_mesh(radii)});
  }

  std::string read_mesh(const XMLElement& mesh, const RobotLink& link, RobotShape& shape) {
    const std::string uri = text_of(mesh.FirstChildElement("uri"));
    if (uri.empty()) return "is a <mesh> without a <uri>";
    shape.scale = vector_of(&mesh, "scale").value_or(Eigen::Vector3d::Ones());
    return shapes_.find_mesh(uri, link, shape);
  }

  void read_joint(const XMLElement& from, SdfFrames& frames, const std::string& prefix,
                  const world::Pose& X_TM) {
    RobotJoint joint;
    const std::string own = name_of(from);
    joint.joint.name = prefix + own;
    joint.line = line_of(xml_.joint_lines, joint.joint.name);
    joint.file = other_file(joint.joint.name);
    const std::string parent = end_of(from, "parent", frames), child = end_of(from, "child", frames);
    if (child == kWorldLink) fail_at(from, file_, "the child of a joint cannot be the world");
    if (parent == child) {
      model_.losses.push_back(remark(
          from, "joint '" + joint.joint.name + "' is not simulated: its parent and child are one link"));
      return;
    }
    joint.parent = parent == kWorldLink ? parent : prefix + parent;
    joint.child = prefix + child;
    const world::Pose X_MJ = frames.pose_of_joint(from);
    joint.joint.X_CJ = frames.pose(child, from).inverse() * X_MJ;
    joint.joint.X_PJ = parent == kWorldLink ? X_TM * X_MJ : frames.pose(parent, from).inverse() * X_MJ;
    read_kind(from, frames, X_MJ, joint.joint);
    const XMLElement* axis = from.FirstChildElement("axis");
    const XMLElement* limit = axis ? axis->FirstChildElement("limit") : nullptr;
    const XMLElement* dynamics = axis ? axis->FirstChildElement("dynamics") : nullptr;
    // Below 0: no limit.
    const double speed = number_or(limit, "velocity", -1.0), effort = number_or(limit, "effort", -1.0);
    if (speed < kUnlimited) joint.maximum_speed = std::max(speed, 0.0);
    if (effort < kUnlimited) joint.maximum_effort = std::max(effort, 0.0);
    joint.stiffness = number_or(dynamics, "spring_stiffness", 0.0);
    joint.rest = number_or(dynamics, "spring_reference", 0.0);
    model_.joints.push_back(std::move(joint));
  }

  // The link at an end of a joint, which may name another frame that it carries; or the world.
  std::string end_of(const XMLElement& joint, const char* tag, SdfFrames& frames) const {
    const XMLElement* end = joint.FirstChildElement(tag);
    const std::string name = text_of(end);
    if (name.empty()) fail_at(joint, file_, std::string("a <joint> needs a <") + tag + ">");
    return name == kWorldLink ? name : frames.link(name, *end);
  }

  void read_kind(const XMLElement& from, SdfFrames& frames, const world::Pose& X_MJ, world::Joint& joint) {
    const std::string type = from.Attribute("type") ? from.Attribute("type") : "";
    const config::Place place = joint_place(joint.name);
    if (type == "fixed" || type == "ball") {
      joint.kind = type == "fixed" ? world::JointKind::kFixed : world::JointKind::kBall;
      return;
    }
    if (type == "universal" || type == "revolute2") {
      joint.kind = world::JointKind::kUniversal;
      return read_universal(from, frames, X_MJ, place, joint);
    }
    joint.kind = type == "prismatic" ? world::JointKind::kSlider : world::JointKind::kHinge;
    if (type == "screw") {
      joint.kind = world::JointKind::kScrew;
      const auto pitch = xml_.pitches.find(joint.name);
      if (pitch == xml_.pitches.end()) throw config::ConfigError(place, "needs a <screw_thread_pitch>");
      joint.pitch_m = pitch->second;
    }
    const XMLElement* axis = from.FirstChildElement("axis");
    if (axis == nullptr)
      model_.losses.push_back(
          remark(from, "joint '" + joint.name + "' gives no <axis>: it moves along z of its frame"));
    joint.axis_J = axis != nullptr ? axis_of(*axis, frames, X_MJ) : Eigen::Vector3d::UnitZ();
    const XMLElement* limit = axis != nullptr ? axis->FirstChildElement("limit") : nullptr;
    const double lower = number_or(limit, "lower", -1e16), upper = number_or(limit, "upper", 1e16);
    joint.limited = type != "continuous" && (lower > -kUnlimited || upper < kUnlimited);
    if (joint.limited) {
      joint.lower = std::max(lower, -kUnlimited);
      joint.upper = std::min(upper, kUnlimited);
    }
    if (joint.lower > joint.upper) throw config::ConfigError(place, "the lower limit is above the upper one");
    const XMLElement* dynamics = axis != nullptr ? axis->FirstChildElement("dynamics") : nullptr;
    joint.damping = number_or(dynamics, "damping", 0.0);
    joint.friction = number_or(dynamics, "friction", 0.0);
  }

  // In the joint's frame. `axis` may give it in any other.
  static Eigen::Vector3d axis_of(const XMLElement& axis, SdfFrames& frames, const world::Pose& X_MJ) {
    const Eigen::Vector3d given = vector_of(&axis, "xyz").value_or(Eigen::Vector3d::UnitZ());
    const XMLElement* xyz = axis.FirstChildElement("xyz");
    const char* frame = xyz ? xyz->Attribute("expressed_in") : nullptr;
    if (frame == nullptr || *frame == '\0') return given.normalized();
    return (X_MJ.q.conjugate() * (frames.pose(frame, *xyz).q * given)).normalized();
  }

  // The first axis belongs to the parent, the second one to the child. The engines want a right angle.
  void read_universal(const XMLElement& from, SdfFrames& frames, const world::Pose& X_MJ,
                      const config::Place& place, world::Joint& joint) {
    const XMLElement *first = from.FirstChildElement("axis"), *second = from.FirstChildElement("axis2");
    if (first == nullptr || second == nullptr)
      throw config::ConfigError(place, "needs an <axis> and an <axis2>");
    joint.axis_J = axis_of(*first, frames, X_MJ);
    joint.axis2_J = axis_of(*second, frames, X_MJ);
    for (const XMLElement* axis : {first, second}) {
      const XMLElement* limit = axis->FirstChildElement("limit");
      const XMLElement* dynamics = axis->FirstChildElement("dynamics");
      if (number_or(limit, "lower", -1e16) <= -kUnlimited && number_or(limit, "upper", 1e16) >= kUnlimited &&
          number_or(dynamics, "damping", 0.0) <= 0.0 && number_or(dynamics, "friction", 0.0) <= 0.0)
        continue;
      model_.losses.push_back({"joint '" + joint.name +
                                   "' turns freely: limits, damping and friction of "
                                   "a universal joint are not simulated",
                               place.line, other_file(joint.name)});
      break;
    }
  }

  // Users count joints in the order of their file.
  void sort_as_in_file() {
    const auto rank = [](const std::vector<std::string>& names) {
      std::map<std::string, std::size_t> ranks;
      for (std::size_t i = 0; i < names.size(); ++i) ranks.emplace(names[i], i);
      return ranks;
    };
    auto links = rank(xml_.links), joints = rank(xml_.joints);
    std::stable_sort(model_.links.begin(), model_.links.end(),
                     [&](const RobotLink& a, const RobotLink& b) { return links[a.name] < links[b.name]; });
    std::stable_sort(model_.joints.begin(), model_.joints.end(),
                     [&](const RobotJoint& a, const RobotJoint& b) {
                       return joints[a.joint.name] < joints[b.joint.name];
                     });
  }

  RobotModel& model_;
  const ModelXml& xml_;
  ShapeIntake shapes_;
  const std::string file_;
  std::vector<config::ConfigError> errors_;  // each about another element
};

}  // namespace

RobotModel read_sdf_robot(tinyxml2::XMLDocument& document, const std::filesystem::path& file,
                          const Packages& packages) {
  RobotModel model;
  model.file = file;
  SdfDocument sdf(document, file.string(), packages);
  const ModelXml& xml = sdf.xml();
  model.losses = xml.losses;
  model.repairs = xml.repairs;
  model.world = xml.world;
  if (xml.world && xml.links.empty()) {
    if (!xml.world->left_out.empty())
      throw config::ConfigError({file.string(), 0, ""},
                                "has no model that can be read. <include> " + xml.world->left_out.front());
    return model;
  }
  SdfReader(model, xml, packages).read(*sdf.model());
  return model;
}

}  // namespace visum::scene

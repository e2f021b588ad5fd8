#include "server/scene/robot_model.h"

#include <algorithm>
#include <map>
#include <sdf/Box.hh>
#include <sdf/Capsule.hh>
#include <sdf/Collision.hh>
#include <sdf/Cylinder.hh>
#include <sdf/Element.hh>
#include <sdf/Ellipsoid.hh>
#include <sdf/Error.hh>
#include <sdf/Geometry.hh>
#include <sdf/Joint.hh>
#include <sdf/JointAxis.hh>
#include <sdf/Link.hh>
#include <sdf/Material.hh>
#include <sdf/Mesh.hh>
#include <sdf/Model.hh>
#include <sdf/ParserConfig.hh>
#include <sdf/Plane.hh>
#include <sdf/Root.hh>
#include <sdf/SDFImpl.hh>
#include <sdf/Sphere.hh>
#include <sdf/Visual.hh>

#include "protocol/config/config.h"
#include "protocol/config/number_text.h"
#include "protocol/config/unknown_name.h"
#include "server/scene/console_capture.h"
#include "server/scene/ellipsoid.h"
#include "server/scene/model_errors.h"
#include "server/scene/model_xml.h"
#include "server/scene/shape_intake.h"
#include "server/scene/urdf_robot.h"
#include "server/scene/xml_checks.h"

namespace visum::scene {
namespace {

constexpr double kUnlimited = 1e6;  // SDF and URDF write 1e16 or infinity for "no limit"

world::Pose to_pose(const ignition::math::Pose3d& pose) {
  const auto& p = pose.Pos();
  const auto& q = pose.Rot();
  return {{p.X(), p.Y(), p.Z()}, Eigen::Quaterniond(q.W(), q.X(), q.Y(), q.Z()).normalized()};
}

Eigen::Vector3d to_vector(const ignition::math::Vector3d& v) {
  return {v.X(), v.Y(), v.Z()};
}

// Copies what sdformat read into a RobotModel, and refuses what is not simulated. Lines of errors come from
// model_xml.cc, because sdformat does not keep them.
class RobotReader {
 public:
  RobotReader(RobotModel& model, const ModelXml& xml, const Packages& packages)
      : model_(model), xml_(xml), shapes_(model, packages), file_(model.file.string()) {}

  void read(const sdf::Model& top) {
    read_model(top, "", {}, top.Static());
    throw_all(std::move(errors_));
    sort_as_in_file();
  }

 private:
  static int line_of(const std::map<std::string, int>& lines, const std::string& name) {
    const auto found = lines.find(name);
    return found == lines.end() ? 0 : found->second;
  }

  config::Place link_place(const std::string& link) const {
    return {file_of(link), line_of(xml_.link_lines, link), "link '" + link + "'"};
  }
  config::Place joint_place(const std::string& joint) const {
    return {file_of(joint), line_of(xml_.joint_lines, joint), "joint '" + joint + "'"};
  }
  // The file in which a link or joint stands.
  std::string file_of(const std::string& name) const {
    const auto other = xml_.files.find(name);
    return other == xml_.files.end() ? file_ : other->second;
  }

  void refuse(const sdf::Errors& errors, const config::Place& place) const {
    if (!errors.empty()) throw config::ConfigError(place, errors.front().Message());
  }

  // X_TM: the pose of this model in the top one. Models nested in a static model are static, too.
  void read_model(const sdf::Model& model, const std::string& prefix, const world::Pose& X_TM,
                  bool is_static) {
    for (std::uint64_t i = 0; i < model.LinkCount(); ++i) {
      const sdf::Link& link = *model.LinkByIndex(i);
      read_link(link, prefix, X_TM, is_static);
      model_.links.back().self_collides = self_collides(link, model);
    }
    for (std::uint64_t i = 0; i < model.JointCount(); ++i)
      keep_error(errors_, [&] { read_joint(*model.JointByIndex(i), prefix, X_TM); });
    for (std::uint64_t i = 0; i < model.ModelCount(); ++i) {
      const sdf::Model& inner = *model.ModelByIndex(i);
      ignition::math::Pose3d pose;
      refuse(inner.SemanticPose().Resolve(pose), {file_, 0, "model '" + inner.Name() + "'"});
      read_model(inner, prefix + inner.Name() + "::", X_TM * to_pose(pose), is_static || inner.Static());
    }
  }

  // A link's own setting overrides its model's.
  static bool self_collides(const sdf::Link& link, const sdf::Model& model) {
    const sdf::ElementPtr element = link.Element();
    return element->HasElement("self_collide") ? element->Get<bool>("self_collide") : model.SelfCollide();
  }

  void read_link(const sdf::Link& from, const std::string& prefix, const world::Pose& X_TM, bool is_static) {
    RobotLink link;
    link.name = prefix + from.Name();
    link.line = line_of(xml_.link_lines, link.name);
    if (file_of(link.name) != file_) link.file = file_of(link.name);
    ignition::math::Pose3d pose;
    refuse(from.SemanticPose().Resolve(pose, "__model__"), link_place(link.name));
    link.X_ML = X_TM * to_pose(pose);
    link.on_ground = is_static;
    if (xml_.massless.count(link.name) == 0) link.mass = read_mass(from);
    if (xml_.without_inertia.count(link.name) != 0) link.mass.inertia_C.setZero();
    for (std::uint64_t i = 0; i < from.CollisionCount(); ++i) {
      const sdf::Collision& collision = *from.CollisionByIndex(i);
      keep_error(errors_, [&] {
        add_shape(collision.Name(), *collision.Geom(), collision.SemanticPose(), nullptr, link);
      });
    }
    for (std::uint64_t i = 0; i < from.VisualCount(); ++i) {
      const sdf::Visual& visual = *from.VisualByIndex(i);
      keep_error(errors_,
                 [&] { add_shape(visual.Name(), *visual.Geom(), visual.SemanticPose(), &visual, link); });
    }
    match_visuals(link);
    model_.links.push_back(std::move(link));
  }

  static MassProperties read_mass(const sdf::Link& link) {
    const auto& inertial = link.Inertial();
    const auto moi = inertial.Moi();  // in the link's axes
    MassProperties mass{inertial.MassMatrix().Mass(), to_vector(inertial.Pose().Pos()), {}};
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 3; ++column)
        mass.inertia_C(static_cast<int>(row), static_cast<int>(column)) = moi(row, column);
    return mass;
  }

  static double opacity_of(const sdf::Visual& visual) {
    return std::clamp(1.0 - static_cast<double>(visual.Transparency()), 0.0, 1.0);
  }

  // `visual` is null for a colliding shape.
  void add_shape(const std::string& name, const sdf::Geometry& geometry, const sdf::SemanticPose& where,
                 const sdf::Visual* visual, RobotLink& link) {
    RobotShape shape;
    shape.name = name;
    shape.link = link.name;
    shape.collides = visual == nullptr;
    if (const auto surface = xml_.surfaces.find({link.name, name});
        shape.collides && surface != xml_.surfaces.end()) {
      shape.surface = surface->second;
      if (!shape.surface.collides) return;
    }
    ignition::math::Pose3d pose;
    refuse(where.Resolve(pose, link.name.substr(link.name.rfind(':') + 1)), link_place(link.name));
    shape.X_LS = to_pose(pose);
    const double opacity = visual ? opacity_of(*visual) : 1.0;
    if (visual && visual->Material()) {
      const auto& c = visual->Material()->Diffuse();
      shape.color = {c.R(), c.G(), c.B(), c.A()};
    }
    const std::string fault = read_geometry(geometry, link, shape);
    shapes_.add(std::move(shape), fault, opacity, link);
  }

  std::string other_file(const std::string& name) const {
    const std::string file = file_of(name);
    return file == file_ ? "" : file;
  }

  // Fills kind, size and mesh. If it cannot, returns the reason.
  std::string read_geometry(const sdf::Geometry& geometry, const RobotLink& link, RobotShape& shape) {
    using world::ShapeKind;
    switch (geometry.Type()) {
      case sdf::GeometryType::BOX: {
        const auto size = geometry.BoxShape()->Size();
        set(shape, ShapeKind::kBox, {size.X(), size.Y(), size.Z()});
        return "";
      }
      case sdf::GeometryType::SPHERE:
        set(shape, ShapeKind::kSphere, {geometry.SphereShape()->Radius(), 0, 0});
        return "";
      case sdf::GeometryType::CYLINDER:
        set(shape, ShapeKind::kCylinder,
            {geometry.CylinderShape()->Radius(), geometry.CylinderShape()->Length(), 0});
        return "";
      case sdf::GeometryType::CAPSULE:
        set(shape, ShapeKind::kCapsule,
            {geometry.CapsuleShape()->Radius(), geometry.CapsuleShape()->Length(), 0});
        return "";
      case sdf::GeometryType::PLANE: {
        const Eigen::Vector3d normal = to_vector(geometry.PlaneShape()->Normal());
        const auto sides = geometry.PlaneShape()->Size();
        set(shape, ShapeKind::kPlane, {});
        if (!shape.collides) shape.size = {sides.X(), sides.Y(), 0};
        shape.X_LS.q = shape.X_LS.q * Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), normal);
        return "";
      }
      case sdf::GeometryType::ELLIPSOID:
        set_ellipsoid(shape, to_vector(geometry.EllipsoidShape()->Radii()));
        return "";
      case sdf::GeometryType::MESH:
        return read_mesh_geometry(*geometry.MeshShape(), link, shape);
      default:
        return "has a form that is not simulated (box, sphere, cylinder, capsule, ellipsoid, plane and mesh "
               "are)";
    }
  }

  // The hull of points on it. Its mesh stands among the converted ones, under a name that no file has.
  void set_ellipsoid(RobotShape& shape, const Eigen::Vector3d& radii) {
    shape.kind = world::ShapeKind::kConvex;
    shape.mesh = "ellipsoid";
    for (const double radius : radii) shape.mesh += " " + config::number_text(radius);
    ColladaMesh& mesh = model_.converted[shape.mesh];
    if (mesh.parts.empty()) mesh.parts.push_back({.mesh = ellipsoid_mesh(radii)});
  }

  static void set(RobotShape& shape, world::ShapeKind kind, std::array<double, 3> size) {
    shape.kind = kind;
    shape.size = size;
  }

  std::string read_mesh_geometry(const sdf::Mesh& mesh, const RobotLink& link, RobotShape& shape) {
    if (!mesh.Submesh().empty()) return "names a submesh, and only whole meshes are read";
    shape.scale = to_vector(mesh.Scale());
    return shapes_.find_mesh(mesh.Uri(), link, shape);
  }

  void read_joint(const sdf::Joint& from, const std::string& prefix, const world::Pose& X_TM) {
    RobotJoint joint;
    joint.joint.name = prefix + from.Name();
    joint.line = line_of(xml_.joint_lines, joint.joint.name);
    if (file_of(joint.joint.name) != file_) joint.file = file_of(joint.joint.name);
    const config::Place place = joint_place(joint.joint.name);
    std::string parent, child;
    refuse(from.ResolveParentLink(parent), place);
    refuse(from.ResolveChildLink(child), place);
    joint.parent = parent == kWorldLink ? parent : prefix + parent;
    joint.child = prefix + child;
    demand_link(joint.child, place);
    if (joint.parent != kWorldLink) demand_link(joint.parent, place);
    ignition::math::Pose3d pose;
    refuse(from.SemanticPose().Resolve(pose, child), place);
    joint.joint.X_CJ = to_pose(pose);
    refuse(from.SemanticPose().Resolve(pose, parent == kWorldLink ? "__model__" : parent), place);
    joint.joint.X_PJ = to_pose(pose);
    if (parent == kWorldLink) joint.joint.X_PJ = X_TM * joint.joint.X_PJ;  // in the top model
    read_kind(from, place, joint.joint);
    if (const sdf::JointAxis* axis = from.Axis()) {
      if (axis->MaxVelocity() < kUnlimited) joint.maximum_speed = std::max(axis->MaxVelocity(), 0.0);
      if (axis->Effort() < kUnlimited) joint.maximum_effort = std::max(axis->Effort(), 0.0);
      joint.stiffness = axis->SpringStiffness();
      joint.rest = axis->SpringReference();
    }
    model_.joints.push_back(std::move(joint));
  }

  void demand_link(const std::string& link, const config::Place& place) const {
    if (xml_.link_lines.count(link) == 0)
      throw config::ConfigError(place, config::unknown_name("link", link, xml_.links));
  }

  void read_kind(const sdf::Joint& from, const config::Place& place, world::Joint& joint) {
    switch (from.Type()) {
      case sdf::JointType::FIXED:
        joint.kind = world::JointKind::kFixed;
        return;
      case sdf::JointType::REVOLUTE:
      case sdf::JointType::CONTINUOUS:
        joint.kind = world::JointKind::kHinge;
        break;
      case sdf::JointType::PRISMATIC:
        joint.kind = world::JointKind::kSlider;
        break;
      case sdf::JointType::BALL:
        joint.kind = world::JointKind::kBall;
        return;
      case sdf::JointType::UNIVERSAL:
      case sdf::JointType::REVOLUTE2:
        joint.kind = world::JointKind::kUniversal;
        return read_universal(from, place, joint);
      case sdf::JointType::SCREW:
        joint.kind = world::JointKind::kScrew;
        joint.pitch_m = pitch_of(joint.name, place);
        break;
      default:
        throw config::ConfigError(place, "joints of this type are not simulated");
    }
    const sdf::JointAxis* axis = from.Axis();
    if (axis == nullptr) throw config::ConfigError(place, "needs an <axis>");
    read_axis(from, *axis, place, joint);
  }

  void read_axis(const sdf::Joint& from, const sdf::JointAxis& axis, const config::Place& place,
                 world::Joint& joint) {
    ignition::math::Vector3d xyz;
    refuse(axis.ResolveXyz(xyz), place);
    joint.axis_J = to_vector(xyz).normalized();
    joint.limited = from.Type() != sdf::JointType::CONTINUOUS &&
                    (axis.Lower() > -kUnlimited || axis.Upper() < kUnlimited);
    if (joint.limited) {
      joint.lower = std::max(axis.Lower(), -kUnlimited);
      joint.upper = std::min(axis.Upper(), kUnlimited);
    }
    if (joint.lower > joint.upper) throw config::ConfigError(place, "the lower limit is above the upper one");
    joint.damping = axis.Damping();
    joint.friction = axis.Friction();
  }

  double pitch_of(const std::string& joint, const config::Place& place) const {
    const auto pitch = xml_.pitches.find(joint);
    if (pitch == xml_.pitches.end()) throw config::ConfigError(place, "needs a <screw_thread_pitch>");
    return pitch->second;
  }

  // The first axis belongs to the parent, the second one to the child. The engines want a right angle.
  void read_universal(const sdf::Joint& from, const config::Place& place, world::Joint& joint) {
    ignition::math::Vector3d xyz, xyz2;
    if (from.Axis(0) == nullptr || from.Axis(1) == nullptr)
      throw config::ConfigError(place, "needs an <axis> and an <axis2>");
    refuse(from.Axis(0)->ResolveXyz(xyz), place);
    refuse(from.Axis(1)->ResolveXyz(xyz2), place);
    joint.axis_J = to_vector(xyz).normalized();
    joint.axis2_J = to_vector(xyz2).normalized();
    for (unsigned int i = 0; i < 2; ++i)
      if (from.Axis(i)->Lower() > -kUnlimited || from.Axis(i)->Upper() < kUnlimited ||
          from.Axis(i)->Damping() > 0 || from.Axis(i)->Friction() > 0) {
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
  std::string file_;
  std::vector<config::ConfigError> errors_;  // each about another element
};

// Unknown and deprecated elements are no errors; they go to sdformat's log.
sdf::ParserConfig quiet_config() {
  sdf::ParserConfig config;
  config.SetFindCallback([](const std::string&) { return std::string(); });  // no look-ups, no downloads
  config.SetWarningsPolicy(sdf::EnforcementPolicy::LOG);
  config.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::LOG);
  config.SetDeprecatedElementsPolicy(sdf::EnforcementPolicy::LOG);
  return config;
}

// Reports why sdformat refused the file: its first error, or what it printed.
[[noreturn]] void fail_load(const sdf::Errors& errors, ConsoleCapture& console, const std::string& file) {
  std::string message = errors.empty() ? console.first_line() : errors.front().Message();
  int line = 0;
  if (!errors.empty()) line = errors.front().LineNumber().value_or(0);
  if (message.empty()) message = "sdformat cannot read it and does not say why";
  throw config::ConfigError({file, line, ""}, message);
}

RobotModel read_sdf_robot(tinyxml2::XMLDocument& document, const std::filesystem::path& file,
                          const Packages& packages) {
  const ModelXml xml = read_sdf(document, file.string(), packages);
  RobotModel model;
  model.file = file;
  model.losses = xml.losses;
  model.repairs = xml.repairs;
  model.world = xml.world;
  if (xml.world && xml.links.empty()) {
    if (!xml.world->left_out.empty())
      throw config::ConfigError({file.string(), 0, ""},
                                "has no model that can be read. <include> " + xml.world->left_out.front());
    return model;
  }
  ConsoleCapture console;
  try {
    sdf::Root root;
    const sdf::Errors errors = root.LoadSdfString(xml.text, quiet_config());
    if (!errors.empty() || root.Model() == nullptr) fail_load(errors, console, file.string());
    RobotReader(model, xml, packages).read(*root.Model());
  } catch (const config::ConfigError&) {
    throw;
  } catch (const std::exception& error) {  // for example a version that is no number
    throw config::ConfigError({file.string(), 0, ""},
                              std::string("sdformat cannot read it: ") + error.what());
  }
  if (model.links.size() != xml.links.size())
    throw config::ConfigError({file.string(), 0, ""}, "sdformat kept " + std::to_string(model.links.size()) +
                                                          " of " + std::to_string(xml.links.size()) +
                                                          " links");
  return model;
}

}  // namespace

RobotModel read_robot_model(const std::filesystem::path& file, const std::string& text,
                            const Packages& packages) {
  if (is_mjcf(text)) return read_mjcf(file, text, packages);
  tinyxml2::XMLDocument document;
  parse_xml(document, text, file.string());
  const XMLElement* root = document.RootElement();
  const std::string tag = root ? root->Name() : "";
  if (tag == "robot") return read_urdf_robot(document, file, packages);
  if (tag == "sdf") return read_sdf_robot(document, file, packages);
  throw config::ConfigError(
      {file.string(), root ? root->GetLineNum() : 0, ""},
      "is neither URDF (<robot>) nor SDF (<sdf>) nor MJCF (<mujoco>): its root is <" + tag + ">");
}

}  // namespace visum::scene

#include "server/scene/urdf_robot.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <set>
#include <string_view>

#include "server/scene/inertia_repair.h"
#include "server/scene/model_errors.h"
#include "server/scene/shape_intake.h"
#include "server/scene/text_cursor.h"
#include "server/scene/values.h"
#include "server/scene/xml_checks.h"

namespace visum::scene {
namespace {

using Color = std::array<double, 4>;

constexpr const char* kFloating = "floating";  // a type of joints
constexpr double kUnlimited = 1e6;             // files write 1e16 or infinity for "no limit"

// The numbers of an attribute that check_urdf() has checked; the default where there is none.
template <typename Numbers>
Numbers numbers_or(const XMLElement* element, const char* attribute, Numbers otherwise) {
  const char* text = element ? element->Attribute(attribute) : nullptr;
  if (text == nullptr) return otherwise;
  TextCursor cursor(text);
  for (double& number : otherwise) parse_number(cursor.word(), number);
  return otherwise;
}

double number_or(const XMLElement* element, const char* attribute, double otherwise) {
  return numbers_or(element, attribute, std::array<double, 1>{otherwise})[0];
}

Eigen::Vector3d vector_or(const XMLElement* element, const char* attribute,
                          const Eigen::Vector3d& otherwise) {
  return numbers_or(element, attribute, otherwise);
}

// The <origin> of `element`.
world::Pose origin_of(const XMLElement& element) {
  const XMLElement* origin = element.FirstChildElement("origin");
  return {vector_or(origin, "xyz", Eigen::Vector3d::Zero()),
          quaternion_from_rpy(vector_or(origin, "rpy", Eigen::Vector3d::Zero())).normalized()};
}

std::string text_or(const XMLElement& element, const char* attribute, const char* otherwise) {
  const char* text = element.Attribute(attribute);
  return text ? text : otherwise;
}

class UrdfReader {
 public:
  UrdfReader(RobotModel& model, const Packages& packages) : model_(model), shapes_(model, packages) {}

  void read(const XMLElement& robot) {
    for (auto material = robot.FirstChildElement("material"); material;
         material = material->NextSiblingElement("material"))
      take_color(*material);
    std::vector<const XMLElement*> links;
    for (auto link = robot.FirstChildElement("link"); link; link = link->NextSiblingElement("link"))
      if (text_or(*link, "name", "") != kWorldLink) links.push_back(link);
    shapes_.convert_ahead(meshes_of(links));
    for (const XMLElement* link : links) read_link(*link);
    for (auto joint = robot.FirstChildElement("joint"); joint; joint = joint->NextSiblingElement("joint"))
      read_joint(*joint);
    throw_all(std::move(errors_));
    place_links();
    release_floating();
  }

 private:
  static constexpr std::array<const char*, 2> kShapes{"collision", "visual"};
  static const XMLElement* form_of(const XMLElement& shape) {
    const XMLElement* geometry = shape.FirstChildElement("geometry");
    return geometry ? geometry->FirstChildElement() : nullptr;
  }

  std::vector<MeshAddress> meshes_of(const std::vector<const XMLElement*>& links) const {
    std::vector<MeshAddress> meshes;
    for (const XMLElement* link : links)
      for (const char* tag : kShapes)
        for (auto shape = link->FirstChildElement(tag); shape; shape = shape->NextSiblingElement(tag)) {
          const XMLElement* form = form_of(*shape);
          if (form && !std::strcmp(form->Name(), "mesh"))
            meshes.push_back({text_or(*form, "filename", ""), model_.file.string()});
        }
    return meshes;
  }

  // A material's own colour, or that of an earlier one of its name.
  std::optional<Color> take_color(const XMLElement& material) {
    const std::string name = text_or(material, "name", "");
    if (const auto known = colors_.find(name); !name.empty() && known != colors_.end()) return known->second;
    const XMLElement* color = material.FirstChildElement("color");
    if (color == nullptr || color->Attribute("rgba") == nullptr) return std::nullopt;
    Color rgba = numbers_or(color, "rgba", Color{0, 0, 0, 1});
    for (double& share : rgba) share = std::min(share, 1.0);
    if (!name.empty()) colors_.emplace(name, rgba);
    return rgba;
  }

  static MassProperties read_mass(const XMLElement& inertial) {
    const XMLElement* inertia = inertial.FirstChildElement("inertia");
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < kMoments.size(); ++i) {
      const auto [row, column] = kMomentPlaces[i];
      moments(row, column) = moments(column, row) = number_or(inertia, kMoments[i], 0.0);
    }
    // The moments are about the centre of mass, in the axes of <origin>.
    const MassProperties own{number_or(inertial.FirstChildElement("mass"), "value", 0.0),
                             Eigen::Vector3d::Zero(), moments};
    return moved(own, origin_of(inertial));
  }

  void read_link(const XMLElement& element) {
    RobotLink link;
    link.name = text_or(element, "name", "");
    link.line = element.GetLineNum();
    if (const XMLElement* inertial = element.FirstChildElement("inertial")) link.mass = read_mass(*inertial);
    for (const char* tag : kShapes) {
      int count = 0;
      for (auto shape = element.FirstChildElement(tag); shape; shape = shape->NextSiblingElement(tag))
        keep_error(errors_, [&] { read_shape(*shape, count++, link); });
    }
    match_visuals(link);
    model_.links.push_back(std::move(link));
  }

  // The `index`th of its kind in the link.
  void read_shape(const XMLElement& element, int index, RobotLink& link) {
    RobotShape shape;
    const std::string otherwise =
        std::string(element.Name()) + (index == 0 ? "" : "_" + std::to_string(index));
    shape.name = text_or(element, "name", otherwise.c_str());
    shape.link = link.name;
    shape.collides = !std::strcmp(element.Name(), "collision");
    shape.X_LS = origin_of(element);
    if (const auto material = element.FirstChildElement("material"); material && !shape.collides)
      shape.color = take_color(*material);
    const XMLElement* form = form_of(element);
    if (form == nullptr) return shapes_.leave_out(shape, "has no form in its <geometry>", link);
    if (std::ranges::find(kForms, std::string_view(form->Name())) == kForms.end())
      return shapes_.leave_out(shape,
                               "has the form <" + std::string(form->Name()) +
                                   ">, which is not simulated (box, sphere, cylinder, capsule and mesh are)",
                               link);
    const std::string fault = read_form(*form, link, shape);
    shapes_.add(std::move(shape), fault, 1.0, link);
  }

  static constexpr std::array<std::string_view, 5> kForms{"box", "sphere", "cylinder", "capsule", "mesh"};

  // Fills kind, size and mesh from one of kForms. If it cannot, returns the reason.
  std::string read_form(const XMLElement& form, const RobotLink& link, RobotShape& shape) {
    using world::ShapeKind;
    const std::string tag = form.Name();
    if (tag == "box") {
      shape.kind = ShapeKind::kBox;
      shape.size = numbers_or(&form, "size", std::array<double, 3>{});
    } else if (tag == "sphere") {
      shape.kind = ShapeKind::kSphere;
      shape.size = {number_or(&form, "radius", 0.0), 0, 0};
    } else if (tag == "cylinder" || tag == "capsule") {
      shape.kind = tag == "capsule" ? ShapeKind::kCapsule : ShapeKind::kCylinder;
      shape.size = {number_or(&form, "radius", 0.0), number_or(&form, "length", 0.0), 0};
    } else {
      shape.scale = vector_or(&form, "scale", Eigen::Vector3d::Ones());
      return shapes_.find_mesh(form.Attribute("filename"), link, shape);
    }
    return "";
  }

  void read_joint(const XMLElement& element) {
    RobotJoint joint;
    joint.joint.name = text_or(element, "name", "");
    joint.line = element.GetLineNum();
    joint.parent = text_or(*element.FirstChildElement("parent"), "link", "");
    joint.child = text_or(*element.FirstChildElement("child"), "link", "");
    joint.joint.X_PJ = origin_of(element);
    read_kind(element, joint);
    if (text_or(element, "type", "") == kFloating) floating_.insert(joint.joint.name);
    model_.joints.push_back(std::move(joint));
  }

  // A link on a floating joint is free. Where there is one, the root stands still by the file itself.
  void release_floating() {
    if (floating_.empty()) return;
    model_.says_what_is_fixed = true;
    for (RobotLink& link : model_.links)
      link.on_ground =
          std::ranges::none_of(model_.joints, [&](const auto& joint) { return joint.child == link.name; });
    std::erase_if(model_.joints, [&](const auto& joint) { return floating_.count(joint.joint.name) != 0; });
  }

  static void read_kind(const XMLElement& element, RobotJoint& joint) {
    const std::string type = text_or(element, "type", "");
    joint.joint.kind = type == "fixed"       ? world::JointKind::kFixed
                       : type == "prismatic" ? world::JointKind::kSlider
                                             : world::JointKind::kHinge;
    if (type == "fixed" || type == kFloating) return;
    if (const XMLElement* mimic = element.FirstChildElement("mimic"))
      joint.mimic = Mimic{text_or(*mimic, "joint", ""), number_or(mimic, "multiplier", 1.0),
                          number_or(mimic, "offset", 0.0), mimic->GetLineNum()};
    const Eigen::Vector3d axis =
        vector_or(element.FirstChildElement("axis"), "xyz", Eigen::Vector3d::UnitX());
    joint.joint.axis_J = axis.stableNormalized();
    const XMLElement* dynamics = element.FirstChildElement("dynamics");
    joint.joint.damping = number_or(dynamics, "damping", 0.0);
    joint.joint.friction = number_or(dynamics, "friction", 0.0);
    joint.stiffness = number_or(dynamics, "spring_stiffness", 0.0);
    joint.rest = number_or(dynamics, "spring_reference", 0.0);
    const XMLElement* limit = element.FirstChildElement("limit");
    const double speed = number_or(limit, "velocity", 0.0), effort = number_or(limit, "effort", 0.0);
    if (speed < kUnlimited) joint.maximum_speed = speed;
    if (effort < kUnlimited) joint.maximum_effort = effort;
    const double lower = number_or(limit, "lower", 0.0), upper = number_or(limit, "upper", 0.0);
    joint.joint.limited =
        type != "continuous" && lower <= upper && (lower > -kUnlimited || upper < kUnlimited);
    if (!joint.joint.limited) return;
    joint.joint.lower = std::max(lower, -kUnlimited);
    joint.joint.upper = std::min(upper, kUnlimited);
  }

  // From the roots to the leaves. The joints form a tree: each link is placed once at most.
  void place_links() {
    std::map<std::string, RobotLink*> links;
    for (RobotLink& link : model_.links) links[link.name] = &link;
    std::multimap<std::string, const RobotJoint*> below;
    for (const RobotJoint& joint : model_.joints) below.emplace(joint.parent, &joint);
    std::vector<std::string> placed{kWorldLink};
    for (const auto& [name, link] : links)
      if (std::ranges::none_of(model_.joints,
                               [&name = name](const auto& joint) { return joint.child == name; }))
        placed.push_back(name);
    for (std::size_t i = 0; i < placed.size(); ++i) {
      const auto upper = links.find(placed[i]);
      const world::Pose X_MP = upper == links.end() ? world::Pose{} : upper->second->X_ML;
      const auto [first, last] = below.equal_range(placed[i]);
      for (auto joint = first; joint != last; ++joint) {
        placed.push_back(joint->second->child);
        links.at(placed.back())->X_ML = X_MP * joint->second->joint.X_PJ;
      }
    }
  }

  RobotModel& model_;
  ShapeIntake shapes_;
  std::map<std::string, Color> colors_;  // by the material's name
  std::set<std::string> floating_;       // joints
  std::vector<config::ConfigError> errors_;
};

}  // namespace

RobotModel read_urdf_robot(tinyxml2::XMLDocument& document, const std::filesystem::path& file,
                           const Packages& packages) {
  const ModelXml xml = check_urdf(document, file.string());
  RobotModel model;
  model.file = file;
  model.collides_by_hulls = true;
  model.losses = xml.losses;
  model.repairs = xml.repairs;
  UrdfReader(model, packages).read(*document.RootElement());
  return model;
}

}  // namespace visum::scene

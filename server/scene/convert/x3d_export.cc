#include <algorithm>
#include <cmath>

#include "server/scene/convert/pairs.h"
#include "server/scene/convert/write_yaml.h"
#include "server/scene/convert/x3d_motors.h"
#include "server/scene/convert/x3d_scene.h"
#include "server/scene/convert/x3d_text.h"
#include "server/scene/convert/yaml_text.h"
#include "server/world/joint_kinds.h"

namespace visum::scene {
namespace {

using world::JointKind;
using world::ShapeKind;

X3dNode node_of(const std::string& type, std::map<std::string, std::string> values = {}) {
  X3dNode node;
  node.type = type;
  node.values = std::move(values);
  return node;
}

X3dNode use_of(const X3dNode& node) {
  X3dNode other;
  other.type = node.type;
  other.use = node.def;
  return other;
}

// A DEF name: unique by its number, and with the characters that X3D allows.
std::string def_name(const std::string& what, std::size_t number, const std::string& name) {
  std::string def = what + std::to_string(number) + "_";
  for (const char c : name) {
    const bool kept = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
    def += kept ? c : '_';
  }
  return def;
}

// Stores YAML in the node's metadata.
void add_metadata(X3dNode& node, const std::string& yaml) {
  node.add("metadata", node_of("MetadataString", {{"name", kMetadataName}, {"value", x3d_texts({yaml})}}));
}

std::string text_of(const Eigen::Vector3d& vector) {
  return exact(vector.data(), 3);
}

std::string color_text(const std::array<double, 4>& color) {
  return exact(color.data(), 3);
}

// Null: X3D has no such joint.
const char* x3d_type(const world::Joint& joint) {
  switch (joint.kind) {
    case JointKind::kHinge:
      return "SingleAxisHingeJoint";
    case JointKind::kSlider:
      return "SliderJoint";
    case JointKind::kBall:
      return "BallJoint";
    case JointKind::kUniversal:
      return "UniversalJoint";
    default:
      return nullptr;
  }
}

// A shape in X3D's terms; some of ours become several.
struct Form {
  X3dNode geometry;
  world::Pose X_SF;  // in the shape's frame
};

// Builds the tree. Each body has a Transform with its visible shapes, and a RigidBody that uses the same
// shapes.
class Exporter {
 public:
  Exporter(const Scene& scene, Output& output, bool physics)
      : scene_(scene), world_(scene.world), output_(output), physics_(physics) {}

  X3dNode root() {
    X3dNode root = node_of("Scene");
    root.add("children", node_of("WorldInfo", {{"title", scene_.name}}));
    for (const Light& light : scene_.looks.lights) add_light(root, light);
    for (const Viewpoint& viewpoint : scene_.looks.viewpoints)
      root.add("children", viewpoint_node(viewpoint));
    if (physics_) driving_ = parts_with_motors(scene_, output_);
    X3dNode collection = node_of("RigidBodyCollection", {{"gravity", text_of(world_.gravity)}});
    add_metadata(collection, settings());
    for (std::size_t i = 0; i < world_.bodies.size(); ++i) add_body(root, collection, i);
    for (std::size_t i = 0; i < world_.joints.size(); ++i) add_joint(collection, world_.joints[i]);
    for (const PartPlan* part : driving_)
      for (const world::JointId joint : part->joints) add_motor(collection, world_.joints[joint.index()]);
    if (physics_) root.add("children", std::move(collection));
    tell_losses();
    return root;
  }

 private:
  // The settings, with the keys of a scene file.
  std::string settings() {
    YamlMap map;
    for (const auto& [key, value] : settings_of(scene_)) map.add(key, value);
    if (const std::string pairs = no_collision(); !pairs.empty()) map.add("no_collision", "[" + pairs + "]");
    if (!driving_.empty()) map.add("parts", motors_yaml(scene_, driving_, output_));
    return map.text();
  }

  // The pairs that no joint of the file keeps apart.
  std::string no_collision() const {
    std::string pairs;
    const auto name = [&](world::BodyId id) { return yaml_text(flat_name(world_.bodies[id.index()].name)); };
    const auto written = [](const world::Joint& joint) { return x3d_type(joint) != nullptr; };
    for (const auto& [a, b] : pairs_beside_joints(world_, written))
      pairs += (pairs.empty() ? "[" : ", [") + name(a) + ", " + name(b) + "]";
    return pairs;
  }

  // Name, pose and surface. A shape that is replaced by other forms has its surface alone, or nothing.
  std::string shape_metadata(const world::Shape& shape) const {
    const bool replaced = shape.kind == ShapeKind::kCapsule || shape.kind == ShapeKind::kPlane;
    YamlMap map;
    if (!replaced) map.add_text("name", shape.name).add_pose(shape.X_BS);
    if (shape.kind == ShapeKind::kConvex) map.add("convex", "true");
    if (shape.surface.index() != 0) map.add_text("surface", world_.surfaces[shape.surface.index()].name);
    return map.empty() ? "" : map.text();
  }

  std::vector<Form> forms_of(const world::Shape& shape) {
    const auto& size = shape.size;
    const auto cylinder = [&] {
      return Form{node_of("Cylinder", {{"radius", exact(size[0])}, {"height", exact(size[1])}}),
                  {Eigen::Vector3d::Zero(), from_y_to_z()}};
    };
    const auto ball_at = [&](double z) {
      return Form{node_of("Sphere", {{"radius", exact(size[0])}}),
                  {Eigen::Vector3d(0, 0, z), Eigen::Quaterniond::Identity()}};
    };
    switch (shape.kind) {
      case ShapeKind::kBox:
        return {{node_of("Box", {{"size", exact(size.data(), 3)}}), {}}};
      case ShapeKind::kSphere:
        return {ball_at(0.0)};
      case ShapeKind::kCylinder:
        return {cylinder()};
      case ShapeKind::kCapsule:
        output_.lose("X3D has no capsules: '" + shape.name + "' is a cylinder with two balls");
        return {cylinder(), ball_at(size[1] / 2), ball_at(-size[1] / 2)};
      case ShapeKind::kPlane:
        output_.lose("X3D has no planes: '" + shape.name + "' is a slab of 200 m by 200 m by 1 m");
        return {{node_of("Box", {{"size", "200 200 1"}}),
                 {Eigen::Vector3d(0, 0, -0.5), Eigen::Quaterniond::Identity()}}};
      case ShapeKind::kConvex:
      case ShapeKind::kMesh:
        break;
    }
    return {{mesh_node(world_.meshes[shape.mesh.index()]), {}}};
  }

  static X3dNode mesh_node(const world::TriangleMesh& mesh) {
    std::string points, indices;
    for (const auto& vertex : mesh.vertices) points += (points.empty() ? "" : " ") + text_of(vertex);
    for (const auto& [a, b, c] : mesh.triangles)
      indices += (indices.empty() ? "" : " ") + std::to_string(a) + " " + std::to_string(b) + " " +
                 std::to_string(c) + " -1";
    X3dNode node = node_of("IndexedFaceSet", {{"coordIndex", indices}, {"solid", "false"}});
    node.add("coord", node_of("Coordinate", {{"point", points}}));
    return node;
  }

  X3dNode appearance_of(const world::Shape& shape) {
    X3dNode appearance = node_of("Appearance");
    appearance.add("material", node_of("Material", {{"diffuseColor", color_text(shape.color)},
                                                    {"transparency", exact(1.0 - shape.color[3])}}));
    if (shape.material >= 0 && scene_.looks.materials[static_cast<std::size_t>(shape.material)].texture >= 0)
      output_.lose("textures are not written to X3D");
    return appearance;
  }

  void add_body(X3dNode& root, X3dNode& collection, std::size_t number) {
    const world::Body& body = world_.bodies[number];
    X3dNode& place = root.add("children", node_of("Transform", {{"translation", text_of(body.X_WB.p)},
                                                                {"rotation", x3d_rotation(body.X_WB.q)}}));
    place.def = def_name("place", number, body.name);
    if (body.kinematic) output_.lose("X3D has no kinematic bodies: '" + body.name + "' stands still");
    X3dNode rigid = rigid_body(body);
    rigid.def = def_name("body", number, body.name);
    bodies_.push_back(use_of(rigid));
    for (const world::Shape& shape : world_.shapes)
      if (shape.body.index() == number) add_shape(place, rigid, shape);
    collection.add("bodies", std::move(rigid));
  }

  // Adds the shape twice: visible in the Transform of its body, and collidable in its RigidBody.
  void add_shape(X3dNode& place, X3dNode& rigid, const world::Shape& shape) {
    const std::string metadata = shape_metadata(shape);
    for (Form& form : forms_of(shape)) {
      const world::Pose X_BF = shape.X_BS * form.X_SF;
      X3dNode visible = node_of("Shape");
      visible.def = def_name("shape", shapes_++, shape.name);
      visible.add("appearance", appearance_of(shape));
      visible.add("geometry", std::move(form.geometry));
      X3dNode collidable = node_of("CollidableShape", {{"translation", text_of(X_BF.p)},
                                                       {"rotation", x3d_rotation(X_BF.q)},
                                                       {"enabled", shape.collides ? "true" : "false"}});
      if (!metadata.empty()) add_metadata(collidable, metadata);
      collidable.add("shape", use_of(visible));
      X3dNode& turned = place.add("children", node_of("Transform", {{"translation", text_of(X_BF.p)},
                                                                    {"rotation", x3d_rotation(X_BF.q)}}));
      turned.add("children", std::move(visible));
      rigid.add("geometry", std::move(collidable));
    }
  }

  X3dNode rigid_body(const world::Body& body) const {
    X3dNode node = node_of("RigidBody", {{"position", text_of(body.X_WB.p)},
                                         {"orientation", x3d_rotation(body.X_WB.q)},
                                         {"fixed", body.fixed || body.kinematic ? "true" : "false"}});
    YamlMap map;
    map.add_text("name", flat_name(body.name)).add_pose(body.X_WB);
    if (!body.fixed && !body.kinematic) {
      const Eigen::Matrix3d rows = body.inertia_C.transpose();  // row by row
      node.values["mass"] = exact(body.mass_kg);
      node.values["inertia"] = exact(rows.data(), 9);
      node.values["centerOfMass"] = text_of(body.p_BC);
      node.values["linearVelocity"] = text_of(body.v_WB);
      node.values["angularVelocity"] = text_of(body.w_WB);
      if (body.engine != 0)
        map.add_text("engine", scene_.engine_names[static_cast<std::size_t>(body.engine)]);
    }
    add_metadata(node, map.text());
    return node;
  }

  void add_joint(X3dNode& collection, const world::Joint& joint) {
    const char* type = x3d_type(joint);
    if (!type) {
      output_.lose("X3D has no joint of type " + std::string(world::info(joint.kind).name) + ": '" +
                   joint.name + "' is left out");
      return;
    }
    X3dNode node = node_of(type);
    node.def = def_name("joint", collection.children.size(), joint.name);
    place_joint(joint, node);
    add_metadata(node, joint_metadata(joint));
    add_sides(joint, node);
    collection.add("joints", std::move(node));
  }

  // Names the bodies of a joint or motor; without body1, the parent is the world.
  void add_sides(const world::Joint& joint, X3dNode& node) const {
    if (joint.parent.valid()) node.add("body1", bodies_[joint.parent.index()]);
    node.add("body2", bodies_[joint.child.index()]);
  }

  // X3D's motors only turn, so a part that drives a slider stands in the metadata alone.
  void add_motor(X3dNode& collection, const world::Joint& joint) const {
    if (joint.kind != JointKind::kHinge) return;
    const world::Pose X_WP = joint.parent.valid() ? world_.bodies[joint.parent.index()].X_WB : world::Pose{};
    X3dNode node = node_of(
        "MotorJoint", {{"enabledAxes", "1"}, {"motor1Axis", text_of(X_WP.q * joint.X_PJ.q * joint.axis_J)}});
    node.def = def_name("motor", collection.children.size(), joint.name);
    add_metadata(node, YamlMap().add_text("joint", flat_name(joint.name)).text());
    add_sides(joint, node);
    collection.add("joints", std::move(node));
  }

  // Writes the joint's place in the world, as X3D does.
  void place_joint(const world::Joint& joint, X3dNode& node) const {
    const world::Pose X_WP = joint.parent.valid() ? world_.bodies[joint.parent.index()].X_WB : world::Pose{};
    const world::Pose X_WJ = X_WP * joint.X_PJ;
    if (joint.kind != JointKind::kSlider) node.values["anchorPoint"] = text_of(X_WJ.p);
    const std::string axis = text_of(X_WJ.q * joint.axis_J);
    if (joint.kind == JointKind::kHinge || joint.kind == JointKind::kSlider) node.values["axis"] = axis;
    if (joint.kind == JointKind::kUniversal) {
      node.values["axis1"] = axis;
      node.values["axis2"] = text_of(X_WJ.q * joint.axis2_J);
    }
    if (!joint.limited) return;
    const bool turns = joint.kind == JointKind::kHinge;
    node.values[turns ? "minAngle" : "minSeparation"] = exact(joint.lower);
    node.values[turns ? "maxAngle" : "maxSeparation"] = exact(joint.upper);
    node.values["stopBounce"] = exact(joint.stop_restitution);
  }

  // Exact values, and those that X3D has no field for.
  static std::string joint_metadata(const world::Joint& joint) {
    YamlMap map;
    map.add_text("name", flat_name(joint.name)).add_pose(joint.X_PJ).add("axis", yaml_list(joint.axis_J));
    if (joint.kind == JointKind::kUniversal) map.add("axis2", yaml_list(joint.axis2_J));
    map.add_unless("friction", joint.friction, 0.0).add_unless("damping", joint.damping, 0.0);
    return map.add_unless("position", joint.initial_position, 0.0).text();
  }

  void add_light(X3dNode& root, const Light& light) {
    if (light.kind == LightKind::kAmbient) {
      root.add("children",
               node_of("DirectionalLight", {{"intensity", "0"},
                                            {"ambientIntensity", exact(std::min(light.intensity, 1.0))},
                                            {"color", color_text(light.color)}}));
      return;
    }
    if (light.shadows) output_.lose("X3D's lights cast no shadows");
    if (light.intensity > 1.0) output_.lose("X3D's lights have an intensity of 1 at most");
    X3dNode node = node_of("DirectionalLight", {{"intensity", exact(std::min(light.intensity, 1.0))},
                                                {"color", color_text(light.color)}});
    if (light.kind != LightKind::kDirectional) {
      node.type = light.kind == LightKind::kSpot ? "SpotLight" : "PointLight";
      node.values["location"] = text_of(light.position);
    }
    if (light.kind != LightKind::kPoint) node.values["direction"] = text_of(light.direction);
    if (light.kind == LightKind::kSpot) node.values["cutOffAngle"] = exact(light.angle_rad);
    root.add("children", std::move(node));
  }

  // An X3D viewpoint looks along -z of its frame, with y up.
  static X3dNode viewpoint_node(const Viewpoint& viewpoint) {
    const Eigen::Vector3d back = (viewpoint.position - viewpoint.target).normalized();
    Eigen::Vector3d right = Eigen::Vector3d::UnitZ().cross(back);
    if (right.norm() < 1e-9) right = Eigen::Vector3d::UnitX();
    right.normalize();
    Eigen::Matrix3d frame;
    frame << right, back.cross(right), back;
    return node_of("Viewpoint", {{"description", viewpoint.name},
                                 {"position", text_of(viewpoint.position)},
                                 {"orientation", x3d_rotation(Eigen::Quaterniond(frame))},
                                 {"centerOfRotation", text_of(viewpoint.target)},
                                 {"fieldOfView", exact(viewpoint.fov_rad)}});
  }

  void tell_losses() {
    for (const auto& model : scene_.models)
      output_.lose("X3D has no models: the links and joints of '" + model.name +
                   "' are bodies and joints of their own, '" + model.name + ".' before their names");
    for (const auto& follower : scene_.followers)
      output_.lose("joint '" + scene_.world.joints[follower.joint.index()].name +
                   "' is written without the joint that it follows");
    for (const auto& part : scene_.parts)
      if (!physics_) output_.lose("VRML97 has no hardware parts: '" + part.context.name + "' is left out");
    for (const auto& sensor : scene_.sensors)
      output_.lose("X3D has no sensors of Visum's: '" + sensor.name + "' is left out");
    for (const auto& agent : scene_.agents)
      output_.lose("X3D has no agents: '" + agent.name + "' is left out");
    if (!scene_.looks.panels.empty()) output_.lose("X3D has no panels");
    if (!physics_ && !world_.bodies.empty())
      output_.lose("VRML97 has no bodies and joints: only what is to be seen is written");
  }

  const Scene& scene_;
  const world::WorldModel& world_;
  Output& output_;
  const bool physics_;
  std::vector<X3dNode> bodies_;           // by BodyId, as USE
  std::vector<const PartPlan*> driving_;  // the parts that can be written
  std::size_t shapes_ = 0;
};

}  // namespace

X3dNode to_x3d(const Scene& scene, Output& output, bool physics) {
  return Exporter(scene, output, physics).root();
}

}  // namespace visum::scene

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "server/scene/convert/x3d_geometry.h"
#include "server/scene/convert/x3d_motors.h"
#include "server/scene/convert/x3d_scene.h"
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

constexpr std::size_t kMaxVertices = 3 * world::kMaxTriangles;
constexpr double kSame = 1e-6;  // m, rad: metadata agrees with the fields beside it up to here

bool same(const Pose& a, const Pose& b) {
  return (a.p - b.p).norm() < kSame && a.q.angularDistance(b.q) < kSame;
}

const X3dNode* child_of(const X3dNode& node, const std::string& field) {
  for (const auto& [name, child] : node.children)
    if (name == field) return &child;
  return nullptr;
}

class Importer {
 public:
  Importer(const X3dNode& root, const std::filesystem::path& file)
      : root_(root), file_(file.string()), draft_(scene_) {
    scene_.file = file;
    scene_.name = file.stem().string();
    scene_.world.engines.push_back({"ode"});
    scene_.engine_places.push_back({file_, 0, "engine"});
    scene_.world.surfaces.push_back({"default"});
    index(root, 0);
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
    read_scenery();
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
  config::Place place_of(const X3dNode& node) const {
    return {file_, node.line, node.type + (node.def.empty() ? "" : " '" + node.def + "'")};
  }
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

  // Notes names, collections, and which shapes belong to bodies.
  void index(const X3dNode& node, int depth) {
    if (!node.def.empty()) defs_[node.def] = &node;
    if (node.type == "RigidBodyCollection") collections_.push_back(&node);
    for (const auto& [field, child] : node.children) index(child, depth + 1);
    if (node.type != "CollidableShape") return;
    if (const X3dNode* shape = child_of(node, "shape")) of_bodies_.insert(&resolved(*shape));
  }

  const X3dNode& resolved(const X3dNode& node) const {
    if (node.use.empty()) return node;
    const auto found = defs_.find(node.use);
    if (found == defs_.end()) fail(node, unknown_use(node.use, defs_));
    return *found->second;
  }

  // The YAML in the metadata node beside a node's fields.
  std::optional<Node> metadata(const X3dNode& node) const {
    const X3dNode* child = child_of(node, "metadata");
    if (!child || child->type != "MetadataString") return {};
    const auto name = child->values.find("name"), value = child->values.find("value");
    if (name == child->values.end() || name->second != kMetadataName || value == child->values.end())
      return {};
    const auto texts = texts_of(value->second);
    if (texts.size() != 1) fail(*child, "metadata of Visum must be one text");
    return config::load_text(texts.front(), file_ + ":" + std::to_string(child->line) + " (metadata)",
                             std::filesystem::path(file_).parent_path());
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

  // The metadata's pose if it agrees with the fields; otherwise the fields'.
  static Pose exact_pose(const std::optional<Node>& metadata, const Pose& fields) {
    if (!metadata) return fields;
    const Pose exact = read_pose_or_identity(*metadata, "pose");
    return same(exact, fields) ? exact : fields;
  }

  std::string name_of(const X3dNode& node, const std::optional<Node>& metadata, const char* what,
                      std::size_t number) const {
    if (metadata && metadata->find("name")) return read_name(metadata->get("name"));
    return node.def.empty() ? what + std::to_string(number) : node.def;
  }

  void read_body(const X3dNode& node) {
    if (node.type != "RigidBody") fail(node, "is not a RigidBody");
    const auto known = metadata(node);
    world::Body body;
    body.name = name_of(node, known, "body_", scene_.world.bodies.size());
    body.fixed = flag_of(node, "fixed", false, file_);
    body.X_WB =
        exact_pose(known, {vector(node, "position", Eigen::Vector3d::Zero()), rotation(node, "orientation")});
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
      if (const X3dNode* inner = child_of(node, "collidable"))
        read_collidable(resolved(*inner), body, X_BC, depth + 1);
      return;
    }
    if (node.type != "CollidableShape") fail(node, "is neither a CollidableShape nor a CollidableOffset");
    const X3dNode* shape = child_of(node, "shape");
    if (!shape) fail(node, "has no shape");
    add_shape(resolved(*shape), body, X_BC, Eigen::Vector3d::Ones(), flag_of(node, "enabled", true, file_),
              metadata(node));
  }

  void add_shape(const X3dNode& node, world::BodyId body, const Pose& X_BN, const Eigen::Vector3d& scale,
                 bool collides, const std::optional<Node>& known) {
    if (node.type != "Shape") fail(node, "is not a Shape");
    const X3dNode* geometry = child_of(node, "geometry");
    if (!geometry) return;
    const std::optional<X3dForm>& form = form_of(resolved(*geometry), scale[0]);
    if (!form) {
      scene_.losses.push_back("line " + std::to_string(geometry->line) + ": " + resolved(*geometry).type +
                              " is not read");
      return;
    }
    world::Shape shape;
    shape.body = body;
    shape.kind = form->kind;
    shape.size = form->size;
    shape.collides = collides;
    if (known && known->boolean_or("convex", false) && shape.kind == world::ShapeKind::kMesh)
      shape.kind = world::ShapeKind::kConvex;
    shape.X_BS = exact_pose(known, X_BN * Pose{Eigen::Vector3d::Zero(), form->q_NS});
    shape.name = name_of(node, known, "shape_", scene_.world.shapes.size());
    if (known && known->find("surface"))
      shape.surface = draft_.surface(known->get("surface"));
    else
      shape.surface = {0};
    read_color(node, shape);
    if (form->kind == world::ShapeKind::kMesh)
      shape.mesh =
          draft_.converted_mesh(form->mesh.name, form->mesh, Eigen::Vector3d::Ones(), place_of(*geometry));
    draft_.add_shape(shape, place_of(*geometry));
  }

  // Converts geometry once for each node and scale, however often it is used.
  const std::optional<X3dForm>& form_of(const X3dNode& node, double scale) {
    const auto [entry, is_new] = forms_.try_emplace({&node, scale});
    if (!is_new) return entry->second;
    entry->second = read_x3d_geometry(node, Eigen::Vector3d::Constant(scale), file_,
                                      [&](const X3dNode& use) -> const X3dNode& { return resolved(use); });
    if (entry->second) entry->second->mesh.name = "mesh_" + std::to_string(forms_.size());
    vertices_ += entry->second ? entry->second->mesh.vertices.size() : 0;
    if (vertices_ > kMaxVertices)
      fail(node, "all meshes have more than " + std::to_string(kMaxVertices) + " points");
    return entry->second;
  }

  void read_color(const X3dNode& node, world::Shape& shape) const {
    const X3dNode* appearance = child_of(node, "appearance");
    if (!appearance) return;
    const X3dNode* material = child_of(resolved(*appearance), "material");
    if (!material) return;
    const auto rgb = numbers(resolved(*material), "diffuseColor", 3, {0.8, 0.8, 0.8});
    const double transparency = numbers(resolved(*material), "transparency", 1, {0.0})[0];
    for (std::size_t i = 0; i < 3; ++i) shape.color[i] = std::clamp(rgb[i], 0.0, 1.0);
    shape.color[3] = std::clamp(1.0 - transparency, 0.0, 1.0);
  }

  const X3dNode* body_node(const X3dNode& joint, const char* field) const {
    const X3dNode* child = child_of(joint, field);
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

  // Reads all shapes outside of bodies.
  void read_scenery() {
    world::Body scenery;
    scenery.name = "scenery";
    scenery.fixed = true;
    walk(root_, {}, 1.0, true, 0, scenery);
  }

  void walk(const X3dNode& given, const Pose& X_WN, double scale, bool collides, int depth,
            const world::Body& scenery) {
    const X3dNode& node = resolved(given);
    if (depth > kMaxX3dDepth)
      fail(given, "nodes are nested more than " + std::to_string(kMaxX3dDepth) + " deep");
    if (++visits_ > kMaxX3dNodes)
      fail(given, "with every USE written out it has more than " + std::to_string(kMaxX3dNodes) + " nodes");
    if (node.type == "RigidBodyCollection" || node.type == "CollisionCollection") return;
    if (node.type == "Shape") {
      if (of_bodies_.contains(&node)) return;
      if (!scenery_.valid()) scenery_ = draft_.add_body(scenery, place_of(node));
      return add_shape(node, scenery_, X_WN, Eigen::Vector3d::Constant(scale), collides, {});
    }
    add_looks(node, X_WN);
    Pose X_WI = X_WN;
    if (node.type == "Transform") X_WI = X_WN * transform_of(node, scale);
    if (node.type == "Collision")
      collides = collides && flag_of(node, "enabled", flag_of(node, "collide", true, file_), file_);
    for (const auto& [field, child] : node.children)
      if (field == "children" || field == "level" || field == "choice")
        walk(child, X_WI, scale, collides, depth + 1, scenery);
  }

  // X_NI: the inner frame in the outer one. `scale`: of the outer frame's lengths; set to the inner frame's.
  Pose transform_of(const X3dNode& node, double& scale) const {
    const Eigen::Vector3d center = vector(node, "center", Eigen::Vector3d::Zero());
    const Eigen::Vector3d factors = vector(node, "scale", Eigen::Vector3d::Ones());
    if (factors[0] != factors[1] || factors[1] != factors[2] || !(factors[0] > 0))
      fail(node, "scale must be the same along all axes, and greater than 0");
    const Eigen::Quaterniond q = rotation(node, "rotation");
    const Eigen::Vector3d p =
        vector(node, "translation", Eigen::Vector3d::Zero()) + center - q * (factors[0] * center);
    const Pose X{scale * p, q};
    scale *= factors[0];
    return X;
  }

  void add_looks(const X3dNode& node, const Pose& X_WN) {
    auto& looks = scene_.looks;
    if (node.type == "Viewpoint" && looks.viewpoints.size() < kMaxViewpoints) {
      Viewpoint viewpoint;
      const auto name = node.values.find("description");
      viewpoint.name = name == node.values.end() || !name_fault(name->second).empty()
                           ? "viewpoint_" + std::to_string(looks.viewpoints.size())
                           : name->second;
      viewpoint.position = X_WN * vector(node, "position", {0, 0, 10});
      const Eigen::Vector3d ahead = X_WN.q * (rotation(node, "orientation") * -Eigen::Vector3d::UnitZ());
      viewpoint.target = viewpoint.position + ahead;
      viewpoint.fov_rad = std::clamp(numbers(node, "fieldOfView", 1, {0.7854})[0], 0.09, 2.09);
      looks.viewpoints.push_back(viewpoint);
    }
    const bool directional = node.type == "DirectionalLight", spot = node.type == "SpotLight";
    if ((!directional && !spot && node.type != "PointLight") || looks.lights.size() == kMaxLights) return;
    Light light;
    light.kind = directional ? LightKind::kDirectional : spot ? LightKind::kSpot : LightKind::kPoint;
    light.intensity = numbers(node, "intensity", 1, {1.0})[0];
    const double ambient = numbers(node, "ambientIntensity", 1, {0.0})[0];
    if (directional && light.intensity == 0.0 && ambient > 0.0) {
      light.kind = LightKind::kAmbient;
      light.intensity = ambient;
    }
    const auto rgb = numbers(node, "color", 3, {1, 1, 1});
    for (std::size_t i = 0; i < 3; ++i) light.color[i] = std::clamp(rgb[i], 0.0, 1.0);
    light.position = X_WN * vector(node, "location", Eigen::Vector3d::Zero());
    const Eigen::Vector3d direction = vector(node, "direction", -Eigen::Vector3d::UnitZ());
    if (!(direction.norm() > 1e-6)) fail(node, "direction must not be zero");
    light.direction = (X_WN.q * direction).normalized();
    light.angle_rad = std::clamp(numbers(node, "cutOffAngle", 1, {0.785398})[0], 0.01, 1.57);
    looks.lights.push_back(light);
  }

  const X3dNode& root_;
  const std::string file_;
  Scene scene_;
  Draft draft_;
  std::map<std::string, const X3dNode*> defs_;
  std::vector<const X3dNode*> collections_;
  std::set<const X3dNode*> of_bodies_;  // only used to ask if they hold a shape
  std::map<const X3dNode*, world::BodyId> bodies_;
  std::set<std::string> motors_;  // joints with a MotorJoint
  std::map<std::pair<const X3dNode*, double>, std::optional<X3dForm>> forms_;
  world::BodyId scenery_;
  std::size_t visits_ = 0, vertices_ = 0;
};

}  // namespace

Scene scene_of_x3d(const X3dNode& root, const std::filesystem::path& file) {
  return Importer(root, file).read();
}

}  // namespace visum::scene

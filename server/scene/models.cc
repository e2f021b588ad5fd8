#include "server/scene/models.h"

#include <algorithm>
#include <map>
#include <set>

#include "protocol/config/number_text.h"
#include "protocol/config/read_file.h"
#include "protocol/config/unknown_name.h"
#include "server/scene/collision_hulls.h"
#include "server/scene/frames.h"
#include "server/scene/joints.h"
#include "server/scene/link_mass.h"
#include "server/scene/mesh_readers.h"
#include "server/scene/mimic.h"
#include "server/scene/model_errors.h"
#include "server/scene/model_xml.h"
#include "server/scene/reader_process.h"
#include "server/scene/robot_loops.h"
#include "server/scene/robot_model.h"
#include "server/scene/values.h"
#include "server/scene/xacro.h"
#include "server/world/joint_kinds.h"

namespace visum::scene {
namespace {

using config::Node;
using config::Place;

constexpr const char* kNoSprings = "engine 'ode' has no springs, use 'impulse'";

// `model` chooses one of a file with a <world>.
RobotModel load_robot(Draft& draft, const Node& entry) {
  RobotModel robot = load_robot_file(draft, entry.get("file"));
  const auto wanted = entry.find("model");
  if (!wanted) return robot;
  if (!robot.world)
    wanted->fail("is for files with a <world>; '" + robot.file.string() + "' holds one model");
  const std::vector<std::string> models = models_of_world(robot);
  if (std::find(models.begin(), models.end(), wanted->text()) == models.end())
    wanted->fail(config::unknown_name("model", wanted->text(), models));
  return one_of_world(robot, wanted->text());
}

// Places one model in the draft.
class Placement {
 public:
  Placement(Draft& draft, const Node& node)
      : draft_(draft), node_(node), name_(read_name(node.get("name"))), robot_(load_robot(draft, node)) {}

  void place() {
    draft_.claim("model", name_, node_.place());
    if (!node_.boolean_or("repair", true)) refuse_repairs();
    X_WM_ = read_world_pose(draft_, node_, "pose");
    draft_.scene.models.push_back({name_, node_, X_WM_});
    draft_.scene.models.back().file = robot_.file.string();
    if (const auto engine = node_.find("engine")) engine_ = draft_.engine(*engine);
    kinematic_ = node_.boolean_or("kinematic", false);
    ground_roots();
    check_link_keys();
    follow_joints(robot_);
    read_collision_meshes();
    for (const RobotLink& link : robot_.links) place_link(link);
    note_hulls();
    for (const JoinedLink& joined : robot_.joined)
      draft_.add_link_name(name_ + "/" + joined.name, {body(joined.into), joined.X_IL});
    for (const RobotJoint& joint : robot_.joints) place_joint(joint);
    note_followers();
    check_joint_keys();
    read_collision_keys();
    for (const std::string& note : robot_.notes) draft_.scene.notes.push_back(said(note));
    note_world();
    report(robot_.losses, draft_.scene.warnings);
    report(robot_.repairs, draft_.scene.repairs);
  }

 private:
  void refuse_repairs() const {
    std::vector<config::ConfigError> errors;
    for (const Remark& repair : robot_.repairs)
      errors.push_back({{file_of(repair.file), repair.line, ""}, repair.text});
    throw_all(std::move(errors));
  }

  // The file of a thing: the model's own, or one that it includes.
  std::string file_of(const std::string& included) const {
    return included.empty() ? robot_.file.string() : included;
  }

  std::string said(const std::string& sentence) const { return "model '" + name_ + "': " + sentence; }

  void report(const std::vector<Remark>& remarks, std::vector<FileRemark>& to) const {
    for (const Remark& remark : remarks) {
      to.push_back({file_of(remark.file), {said(remark.text), remark.line}});
      draft_.scene.losses.push_back(to.back().remark.text);
    }
  }

  Place link_place(const RobotLink& link) const {
    return {file_of(link.file), link.line, "link '" + link.name + "'"};
  }
  Place joint_place(const RobotJoint& joint) const {
    return {file_of(joint.file), joint.line, "joint '" + joint.joint.name + "'"};
  }
  world::BodyId body(const std::string& link) const { return draft_.body(name_ + "/" + link); }

  // The scene has a gravity of its own.
  void note_world() {
    if (!robot_.world || !robot_.world->gravity || draft_.world_settings) return;
    if ((*robot_.world->gravity - draft_.scene.world.gravity).norm() > 0.01)
      robot_.losses.push_back({"the world's <gravity> is not read: the scene's 'gravity' acts", 0});
  }

  // With `fixed: true`, links that hang on no joint stand still. A world's file says itself what is static.
  void ground_roots() {
    if (!node_.boolean_or("fixed", !robot_.world && !robot_.says_what_is_fixed)) return;
    std::set<std::string> hanging;
    for (const RobotJoint& joint : robot_.joints) hanging.insert(joint.child);
    for (RobotLink& link : robot_.links)
      if (hanging.count(link.name) == 0) link.on_ground = true;
  }

  void read_collision_meshes() {
    const auto node = node_.find("collision_meshes");
    by_hulls_ = node ? node->one_of({"hulls", "triangles"}) == "hulls" : robot_.collides_by_hulls;
  }

  void note_hulls() {
    if (hulls_ > 0)
      robot_.repairs.push_back({"meshes of moving links collide as their convex hulls: " +
                                    std::to_string(hulls_) + " ('collision_meshes: triangles' keeps them)",
                                0});
  }

  // The keys of `surfaces:` must be links of the file, including links that were joined into others.
  void check_link_keys() const {
    const auto surfaces = node_.find("surfaces");
    if (!surfaces) return;
    std::vector<std::string> known;
    for (const RobotLink& link : robot_.links) known.push_back(link.name);
    for (const JoinedLink& joined : robot_.joined) known.push_back(joined.name);
    surfaces->allow_only({known.begin(), known.end()});
  }

  void place_link(const RobotLink& link) {
    if (link.name.empty() || link.name.size() > kMaxNameBytes)
      throw config::ConfigError(link_place(link),
                                "its name must have 1 to " + std::to_string(kMaxNameBytes) + " bytes");
    world::Body body;
    body.name = name_ + "/" + link.name;
    body.model = name_;
    body.fixed = link.on_ground;
    body.kinematic = kinematic_ && !body.fixed;
    body.engine = body.kinematic ? world::kNoEngine : engine_;
    body.X_WB = X_WM_ * link.X_ML;
    std::vector<world::Shape> shapes;
    for (const RobotShape& shape : link.shapes) shapes.push_back(shape_of(link, shape));
    if (!body.fixed && !body.kinematic) set_mass(link, shapes, body);
    if (!body.fixed && by_hulls_) hulls_ += take_hulls(draft_, shapes, link_place(link));
    const world::BodyId id = draft_.add_body(body, link_place(link));
    for (world::Shape& shape : shapes) {
      shape.body = id;
      draft_.add_shape(shape, link_place(link));
    }
  }

  void set_mass(const RobotLink& link, const std::vector<world::Shape>& shapes, world::Body& body) {
    const double density = node_.number_or("density", kDensity, config::kPositive);
    const auto [mass, repair] = repaired_mass(link.mass, shapes, draft_.scene.world.meshes, density);
    if (!repair.empty()) {
      if (!node_.boolean_or("repair", true)) refuse_mass(link);
      robot_.repairs.push_back({"link '" + link.name + "' " + repair, link.line});
    }
    body.mass_kg = mass.mass_kg;
    body.p_BC = mass.com;
    body.inertia_C = mass.inertia_C;
  }

  [[noreturn]] void refuse_mass(const RobotLink& link) const {
    throw config::ConfigError(link_place(link), link.mass.mass_kg <= 0
                                                    ? "moves but has no mass: give it an <inertial>"
                                                    : "moves but has no inertia that a solid could have");
  }

  world::Shape shape_of(const RobotLink& link, const RobotShape& from) {
    world::Shape shape;
    shape.name = from.name;
    shape.kind = from.kind;
    shape.size = from.size;
    shape.X_BS = from.X_LS;
    shape.collides = from.collides;
    shape.color = from.color.value_or(shape.color);
    shape.surface = surface_of(from);
    if (!from.mesh.empty()) shape.mesh = mesh_of(from, link);
    return shape;
  }

  // The mesh of a shape: from its own file, or a part of a converted Collada file.
  world::MeshId mesh_of(const RobotShape& from, const RobotLink& link) {
    const auto converted = robot_.converted.find(from.mesh);
    if (converted == robot_.converted.end()) {
      const auto seen = robot_.seen.find(from.mesh);
      return draft_.mesh(from.mesh, from.scale, link_place(link),
                         seen == robot_.seen.end() ? nullptr : &seen->second);
    }
    return draft_.converted_mesh(from.mesh.string() + "#" + std::to_string(from.mesh_part),
                                 converted->second.parts[from.mesh_part].mesh, from.scale, link_place(link));
  }

  // The scene's own word comes before the file's.
  world::SurfaceId surface_of(const RobotShape& shape) const {
    if (const auto surfaces = node_.find("surfaces"))
      if (const auto surface = surfaces->find(shape.link)) return draft_.surface(*surface);
    if (const auto surface = node_.find("surface")) return draft_.surface(*surface);
    if (!shape.surface.says_anything()) return {0};
    world::Surface own = draft_.scene.world.surfaces.front();
    own.friction = shape.surface.friction.value_or(own.friction);
    own.restitution = shape.surface.restitution.value_or(own.restitution);
    own.torsional_friction = shape.surface.torsional_friction.value_or(own.torsional_friction);
    return draft_.surface_like(own, node_.place());
  }

  bool stands_still(world::BodyId body) const {
    return !body.valid() || draft_.scene.world.bodies[body.index()].fixed;
  }

  void place_joint(const RobotJoint& from) {
    world::Joint joint = from.joint;
    joint.name = name_ + "/" + from.joint.name;
    joint.child = body(from.child);
    if (from.parent == kWorldLink)
      joint.X_PJ = X_WM_ * joint.X_PJ;
    else
      joint.parent = body(from.parent);
    if (stands_still(joint.child)) {
      if (!stands_still(joint.parent))
        throw config::ConfigError(joint_place(from),
                                  "its child is fixed and its parent moves: exchange the two");
      robot_.losses.push_back({"joint '" + from.joint.name + "' is not simulated: both its links are fixed",
                               from.line, from.file});
      return;
    }
    if (is_lost_spring(from)) return;
    joint.initial_position = initial_position(from);
    const auto given = node_.find("joints");
    if (!given || !given->find(from.joint.name)) keep_loop_closed(robot_, from, joint);
    draft_.add_joint(joint, joint_place(from));
    if (from.stiffness != 0.0) add_spring(from, joint);
    draft_.drive_limits[joint.name] = {from.maximum_speed, from.maximum_effort};
    placed_.push_back(from.joint.name);
  }

  void note_followers() {
    for (const RobotJoint& joint : robot_.joints) {
      if (!joint.mimic || !is_placed(joint.joint.name) || !is_placed(joint.mimic->leader)) continue;
      draft_.followers[name_ + "/" + joint.joint.name] = {name_ + "/" + joint.mimic->leader,
                                                          joint.mimic->multiplier, joint.mimic->offset};
      robot_.notes.push_back("joint '" + joint.joint.name + "' follows '" + joint.mimic->leader +
                             "' by a servo; the load on it does not reach that joint");
    }
  }

  bool is_placed(const std::string& joint) const {
    return std::find(placed_.begin(), placed_.end(), joint) != placed_.end();
  }

  bool is_lost_spring(const RobotJoint& from) {
    if (world::info(from.joint.kind).holds_anything || draft_.is_impulse(engine_)) return false;
    robot_.losses.push_back(
        {"'" + from.joint.name + "' is not simulated: " + kNoSprings, from.line, from.file});
    return true;
  }

  // A spring about a hinge becomes a joint of its own beside it.
  void add_spring(const RobotJoint& from, const world::Joint& beside) {
    const char* fault = from.stiffness < 0.0                      ? "its stiffness is negative"
                        : beside.kind != world::JointKind::kHinge ? "only hinges have springs"
                        : !draft_.is_impulse(engine_)             ? kNoSprings
                                                                  : nullptr;
    if (fault != nullptr) {
      robot_.losses.push_back(
          {"joint '" + from.joint.name + "' has a spring, which is not simulated: " + fault, from.line,
           from.file});
      return;
    }
    world::Joint spring;
    spring.name = beside.name + "_spring";
    spring.kind = world::JointKind::kTorsionSpring;
    spring.parent = beside.parent;
    spring.child = beside.child;
    spring.X_PJ = beside.X_PJ;
    spring.X_CJ = beside.X_CJ;
    spring.axis_J = beside.axis_J;
    spring.stiffness = from.stiffness;
    spring.rest = from.rest;
    draft_.add_joint(spring, joint_place(from));
  }

  // Joints follow others in no circle: follow_joints() has seen to it.
  double initial_position(const RobotJoint& from) const {
    const world::Joint& joint = from.joint;
    const auto joints = node_.find("joints");
    const auto given = joints ? joints->find(from.joint.name) : std::nullopt;
    if (!given) {
      const double initial =
          from.mimic ? from.mimic->multiplier * initial_position(*find_joint(robot_, from.mimic->leader)) +
                           from.mimic->offset
                     : from.initial;
      return joint.limited ? std::clamp(initial, joint.lower, joint.upper) : initial;
    }
    const double position = given->number(kPlaceable);
    if (joint.limited && (position < joint.lower || position > joint.upper))
      given->fail("must be within the joint's limits " + config::number_text(joint.lower) + " and " +
                  config::number_text(joint.upper) + ", is " + given->text());
    return position;
  }

  void check_joint_keys() const {
    if (const auto joints = node_.find("joints")) joints->allow_only({placed_.begin(), placed_.end()});
  }

  void read_collision_keys() {
    if (const auto pairs = node_.find("no_collision")) read_pairs(*pairs);
    for (const auto& [a, b] : robot_.no_collision)
      if (body(a) != body(b)) draft_.forbid_collision(body(a), body(b));
    if (node_.boolean_or("self_collision", false)) return;
    const bool none = node_.find("self_collision").has_value();
    if (none && robot_.links.size() > kMaxLinksWithoutCollision)
      node_.get("self_collision")
          .fail("can be off for models of at most " + std::to_string(kMaxLinksWithoutCollision) + " links");
    for (std::size_t a = 0; a < robot_.links.size(); ++a)
      for (std::size_t b = a + 1; b < robot_.links.size(); ++b)
        if (none || stay_apart(robot_.links[a], robot_.links[b]))
          draft_.forbid_collision(body(robot_.links[a].name), body(robot_.links[b].name));
  }

  // `no_collision` is a list of pairs, or a map with rules.
  void read_pairs(const Node& node) {
    if (node.kind() != Node::Kind::kMap) return read_no_collision(draft_, node, name_ + "/");
    node.allow_only({"pairs", "overlapping", "within_joints"});
    if (const auto pairs = node.find("pairs")) read_no_collision(draft_, *pairs, name_ + "/");
    draft_.scene.models.back().overlaps_never_collide = node.boolean_or("overlapping", false);
    if (const auto joints = node.find("within_joints"))
      part_neighbours(static_cast<int>(joints->integer(1, kMaxJointsBetween)));
  }

  // Links with at most `most` joints between them never collide. Direct neighbours never do anyway.
  void part_neighbours(int most) {
    std::map<std::string, std::vector<std::string>> neighbours;
    for (const RobotJoint& joint : robot_.joints) {
      if (joint.parent == kWorldLink) continue;
      neighbours[joint.parent].push_back(joint.child);
      neighbours[joint.child].push_back(joint.parent);
    }
    std::size_t pairs = 0;
    for (const RobotLink& link : robot_.links) {
      std::set<std::string> reached{link.name};
      std::vector<std::string> last{link.name};
      for (int joints = 1; joints <= most; ++joints) {
        std::vector<std::string> next;
        for (const std::string& from : last)
          for (const std::string& to : neighbours[from])
            if (reached.insert(to).second) next.push_back(to);
        last = std::move(next);
        for (const std::string& other : last) {
          if (other < link.name || joints == 1) continue;  // each pair once
          draft_.forbid_collision(body(link.name), body(other));
          ++pairs;
        }
      }
    }
    if (pairs > 0)
      robot_.repairs.push_back({"pairs of links with 2 to " + std::to_string(most) +
                                    " joints between them never collide: " + std::to_string(pairs),
                                0});
  }

  // True if the model's file keeps these links apart. A nested model decides for its own links only.
  static bool stay_apart(const RobotLink& a, const RobotLink& b) {
    const auto model_of = [](const std::string& link) {
      const std::size_t end = link.rfind("::");
      return end == std::string::npos ? std::string() : link.substr(0, end);
    };
    return !a.self_collides && !b.self_collides && model_of(a.name) == model_of(b.name);
  }

  static constexpr double kDensity = 1000.0;                     // kg/m³, of links without mass: water
  static constexpr std::size_t kMaxLinksWithoutCollision = 500;  // the number of pairs grows with the square

  static constexpr int kMaxJointsBetween = 16;

  Draft& draft_;
  const Node node_;
  const std::string name_;
  RobotModel robot_;
  world::Pose X_WM_;
  std::int32_t engine_ = 0;
  bool kinematic_ = false;
  bool by_hulls_ = false;
  std::size_t hulls_ = 0;            // meshes that were replaced
  std::vector<std::string> placed_;  // names of joints
};

}  // namespace

namespace {

constexpr ReaderBounds kXacroBounds{std::chrono::seconds(30), kMaxModelBytes, "URDF"};

// The URDF that the user's xacro makes of a file with macros. A recording keeps it in place of the file. A
// file that is called otherwise (.urdf) may be read without it.
std::string expanded(const std::filesystem::path& file, const std::string& text,
                     std::vector<Remark>& losses) {
  const std::filesystem::path program = find_xacro();
  if (!program.empty()) {
    const std::string urdf = expand_xacro(program, file, kXacroBounds);
    config::note_file(file, urdf);
    losses.push_back(
        {"xacro has expanded it: lines are those of what 'xacro " + file.string() + "' prints", 0});
    return urdf;
  }
  const std::string advice =
      "there is no program 'xacro' in PATH; where there is one, run: " + xacro_command(file);
  if (lower_extension(file) == ".xacro")
    throw config::ConfigError({file.string(), 0, ""}, "holds macros of xacro, and " + advice);
  losses.push_back({"its macros of xacro are not read: " + advice, 0});
  return text;
}

}  // namespace

RobotModel load_robot_file(Draft& draft, const Node& file_node) {
  const std::filesystem::path file = read_path(file_node);
  auto& known = draft.robots[file.string()];
  if (known) return *known;
  config::FileContent content = config::read_file(file, kMaxModelBytes);
  if (!content.fault.empty()) file_node.fail("'" + file.string() + "': " + content.fault);
  std::vector<Remark> losses;
  if (needs_xacro(file, content.bytes)) content.bytes = expanded(file, content.bytes, losses);
  RobotModel robot = read_robot_model(file, content.bytes, draft.packages);
  robot.losses.insert(robot.losses.begin(), losses.begin(), losses.end());
  join_links(robot);
  known = std::make_shared<const RobotModel>(robot);
  return robot;
}

void read_model(Draft& draft, const Node& node) {
  node.allow_only({"name", "file", "pose", "fixed", "kinematic", "joints", "surface", "surfaces",
                   "self_collision", "no_collision", "engine", "repair", "density", "model",
                   "collision_meshes"});
  Placement(draft, node).place();
}

}  // namespace visum::scene

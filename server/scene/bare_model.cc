#include "server/scene/bare_model.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>

#include "protocol/config/number_text.h"
#include "server/scene/bodies.h"
#include "server/scene/mesh_readers.h"
#include "server/scene/models.h"
#include "server/scene/robot_model.h"
#include "server/scene/values.h"
#include "server/world/joint_kinds.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;

// The lowest z of a shape in the world.
double lowest(const world::WorldModel& model, const world::Shape& shape) {
  const world::Pose X_WS = model.bodies[shape.body.index()].X_WB * shape.X_BS;
  if (shape.mesh.valid()) {
    double z = 1e9;
    for (const Eigen::Vector3d& vertex : model.meshes[shape.mesh.index()].vertices)
      z = std::min(z, (X_WS * vertex).z());
    return z;
  }
  const Eigen::Vector3d up = X_WS.q.conjugate() * Eigen::Vector3d::UnitZ();  // in the shape's frame
  const double radius = shape.size[0], half_length = shape.size[1] / 2;
  switch (shape.kind) {
    case world::ShapeKind::kBox:
      return X_WS.p.z() - up.cwiseAbs().dot(Eigen::Vector3d(shape.size[0], shape.size[1], shape.size[2])) / 2;
    case world::ShapeKind::kSphere:
      return X_WS.p.z() - radius;
    case world::ShapeKind::kCapsule:
      return X_WS.p.z() - radius - half_length * std::abs(up.z());
    case world::ShapeKind::kCylinder:
      return X_WS.p.z() - radius * up.head<2>().norm() - half_length * std::abs(up.z());
    default:
      return X_WS.p.z();
  }
}

constexpr double kNanometres = 1e9;  // in a metre

double floor_height(const world::WorldModel& model) {
  double z = 0.0;
  for (const world::Shape& shape : model.shapes)
    if (shape.collides) z = std::min(z, lowest(model, shape));
  return std::round(z * kNanometres) / kNanometres;
}

// The joints that the part drives, if the model's file names them; else it drives all.
std::string driven(const RobotModel& robot) {
  std::string list;
  for (const std::string& joint : robot.actuated) list += (list.empty() ? "" : ", ") + yaml_quoted(joint);
  return list.empty() ? "" : ", joints: [" + list + "]";
}

// Chooses the engine that has all joints and springs of the file.
void choose_engine(const RobotModel& robot, Draft& draft) {
  const bool beyond_ode = std::any_of(robot.joints.begin(), robot.joints.end(), [](const RobotJoint& joint) {
    const bool is_spring = !world::info(joint.joint.kind).holds_anything;
    return is_spring || joint.stiffness > 0.0 || joint.joint.kind == world::JointKind::kScrew;
  });
  if (!beyond_ode) return;
  draft.scene.world.engines[0].name = "impulse";
  draft.scene.notes.push_back("engine 'impulse' moves it, because it has springs or screws");
}

// Joints that a part can drive.
bool has_drivable_joints(const world::WorldModel& model, std::size_t first) {
  return std::any_of(model.joints.begin() + static_cast<std::ptrdiff_t>(first), model.joints.end(),
                     [](const world::Joint& joint) { return world::is_drivable(joint.kind); });
}

struct BareEntry {
  std::string name;        // of the model and of its part
  std::string model_keys;  // further keys of the model's entry: ", model: 'door'"
  std::string part_keys;   // and of the part's
};

// Places one model with a part for its joints.
void place_with_part(Draft& draft, const fs::path& file, const BareEntry& entry) {
  const auto node = [&](const std::string& yaml) {
    return config::load_text(yaml, file.string(), file.parent_path());
  };
  const std::size_t joints = draft.scene.world.joints.size();
  const std::string name = yaml_quoted(entry.name);
  read_model(draft, node("{name: " + name + ", file: " + yaml_quoted(file.filename().string()) +
                         entry.model_keys + ", no_collision: {overlapping: true}}"));
  if (has_drivable_joints(draft.scene.world, joints))
    draft.part_entries.push_back(
        node("{name: " + name + ", kind: ideal_joints, model: " + name + entry.part_keys + "}"));
}

// A step that a world's file may set. Others are hints for another engine.
constexpr double kLongestStepS = 0.01;

void take_settings(const ModelWorld& from, const fs::path& file, Draft& draft) {
  world::WorldModel& model = draft.scene.world;
  draft.world_settings = true;
  if (from.gravity && from.gravity->norm() < 1e6) model.gravity = *from.gravity;
  if (!from.step_s) return;
  const double tick_ns = std::round(*from.step_s * 1e9);
  if (tick_ns >= 1e3 && *from.step_s <= kLongestStepS)
    model.tick_ns = static_cast<std::int64_t>(tick_ns);
  else
    draft.scene.warnings.push_back(
        {file.string(),
         {"the step of " + config::number_text(*from.step_s) + " s is not taken: a tick is 1 ms", 0}});
}

// A name that a scene can have: the model's own, or one made of it.
std::string placed_name(const std::string& model, std::set<std::string>& taken) {
  std::string name = name_fault(model).empty() ? model : name_of_model_file(model);
  while (!taken.insert(name).second) name += "_";
  return name;
}

// Each model of the world becomes one of the scene. Remarks are about the file as a whole.
void read_bare_world(Draft& draft, const fs::path& file, const RobotModel& world) {
  take_settings(*world.world, file, draft);
  std::set<std::string> taken;
  for (const std::string& model : models_of_world(world))
    place_with_part(draft, file, {placed_name(model, taken), ", model: " + yaml_quoted(model), ""});
  const auto report = [&](const std::vector<Remark>& remarks, std::vector<FileRemark>& to) {
    for (const Remark& remark : remarks) {
      to.push_back({remark.file.empty() ? file.string() : remark.file, {remark.text, remark.line}});
      draft.scene.losses.push_back(remark.text);
    }
  };
  std::vector<Remark> between;
  for (const RobotJoint& joint : world.joints)
    if (joint.joint.name.find("::") == std::string::npos)
      between.push_back({"joint '" + joint.joint.name +
                             "' between models is not simulated in a bare file: "
                             "name the file in a scene",
                         joint.line, joint.file});
  report(between, draft.scene.warnings);
  report(world.losses, draft.scene.warnings);
  report(world.repairs, draft.scene.repairs);
}

}  // namespace

std::string name_of_model_file(const fs::path& file) {
  fs::path stem = file.stem();
  if (lower_extension(file) == ".xacro") stem = stem.stem();  // arm.urdf.xacro
  std::string name = stem.string().substr(0, kMaxNameBytes);
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-') c = '_';
  return name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) ? "model_" + name : name;
}

bool is_model_file(const fs::path& file) {
  const std::string extension = lower_extension(file);
  return extension == ".urdf" || extension == ".sdf" || extension == ".world" || extension == ".xacro" ||
         extension == ".mjcf" || extension == ".xml";
}

void read_bare_model(Draft& draft, const fs::path& file) {
  const std::string name = name_of_model_file(file);
  const auto node = [&](const std::string& yaml) {
    return config::load_text(yaml, file.string(), file.parent_path());
  };
  const RobotModel robot =
      load_robot_file(draft, node("{file: " + yaml_quoted(file.filename().string()) + "}").get("file"));
  choose_engine(robot, draft);
  if (robot.world) return read_bare_world(draft, file, robot);
  if (robot.gravity) draft.scene.world.gravity = *robot.gravity;
  place_with_part(draft, file, {name, "", driven(robot)});
  const world::WorldModel& model = draft.scene.world;
  const bool has_floor = std::any_of(model.shapes.begin(), model.shapes.end(), [](const world::Shape& s) {
    return s.kind == world::ShapeKind::kPlane;
  });
  if (!has_floor)
    read_body(draft, node("{name: floor, fixed: true, pose: {xyz: [0, 0, " +
                          config::number_text(floor_height(model)) + "]}, shapes: [{plane: true}]}"));
}

void place_bare_model(Draft& draft, const fs::path& file, const std::string& name) {
  const auto file_node = config::load_text("{file: " + yaml_quoted(file.filename().string()) + "}",
                                           file.string(), file.parent_path())
                             .get("file");
  const RobotModel robot = load_robot_file(draft, file_node);
  if (!robot.world) return place_with_part(draft, file, {name, "", driven(robot)});
  const auto models = models_of_world(robot);
  if (models.size() != 1)
    throw config::ConfigError({file.string(), 0, ""},
                              "holds a world of " + std::to_string(models.size()) + " models, not one");
  place_with_part(draft, file, {name, ", model: " + yaml_quoted(models.front()), ""});
}

}  // namespace visum::scene

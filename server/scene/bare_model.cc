#include "server/scene/bare_model.h"

#include <algorithm>
#include <cctype>

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

// The file's name as a name of the scene.
std::string name_of(const fs::path& file) {
  std::string name = file.stem().string().substr(0, kMaxNameBytes);
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-') c = '_';
  return name.empty() || std::isdigit(static_cast<unsigned char>(name[0])) ? "model_" + name : name;
}

std::string in_quotes(const std::string& text) {
  std::string quoted = "'";
  for (const char c : text) quoted += c == '\'' ? "''" : std::string(1, c);
  return quoted + "'";
}

// The lowest z of a shape in the world. Of round shapes it may be a little too low.
double lowest(const world::WorldModel& model, const world::Shape& shape) {
  const world::Pose X_WS = model.bodies[shape.body.index()].X_WB * shape.X_BS;
  if (shape.mesh.valid()) {
    double z = 1e9;
    for (const Eigen::Vector3d& vertex : model.meshes[shape.mesh.index()].vertices)
      z = std::min(z, (X_WS * vertex).z());
    return z;
  }
  Eigen::Vector3d half = Eigen::Vector3d::Zero();
  if (shape.kind == world::ShapeKind::kBox)
    half = Eigen::Vector3d(shape.size[0], shape.size[1], shape.size[2]) / 2;
  else if (shape.kind != world::ShapeKind::kPlane)
    half = {shape.size[0], shape.size[0], std::max(shape.size[0], shape.size[1] / 2 + shape.size[0])};
  return X_WS.p.z() - (X_WS.q.toRotationMatrix().row(2).cwiseAbs() * half).value();
}

double floor_height(const world::WorldModel& model) {
  double z = 0.0;
  for (const world::Shape& shape : model.shapes)
    if (shape.collides) z = std::min(z, lowest(model, shape));
  return z;
}

// The joints that the part drives, if the model's file names them; else it drives all.
std::string driven(const RobotModel& robot) {
  std::string list;
  for (const std::string& joint : robot.actuated) list += (list.empty() ? "" : ", ") + in_quotes(joint);
  return list.empty() ? "" : ", joints: [" + list + "]";
}

}  // namespace

bool is_model_file(const fs::path& file) {
  const std::string extension = lower_extension(file);
  return extension == ".urdf" || extension == ".sdf" || extension == ".world" || extension == ".mjcf" ||
         extension == ".xml";
}

void read_bare_model(Draft& draft, const fs::path& file) {
  const std::string name = name_of(file);
  const auto node = [&](const std::string& yaml) {
    return config::load_text(yaml, file.string(), file.parent_path());
  };
  read_model(draft, node("{name: " + name + ", file: " + in_quotes(file.filename().string()) +
                         ", no_collision: {overlapping: true}}"));
  const RobotModel& robot = *draft.robots.begin()->second;
  if (robot.gravity) draft.scene.world.gravity = *robot.gravity;
  const world::WorldModel& model = draft.scene.world;
  const bool has_floor = std::any_of(model.shapes.begin(), model.shapes.end(), [](const world::Shape& s) {
    return s.kind == world::ShapeKind::kPlane;
  });
  if (!has_floor)
    read_body(draft, node("{name: floor, fixed: true, pose: {xyz: [0, 0, " +
                          config::number_text(floor_height(model)) + "]}, shapes: [{plane: true}]}"));
  if (std::any_of(model.joints.begin(), model.joints.end(),
                  [](const world::Joint& joint) { return world::is_drivable(joint.kind); }))
    draft.part_entries.push_back(
        node("{name: " + name + ", kind: ideal_joints, model: " + name + driven(robot) + "}"));
}

}  // namespace visum::scene

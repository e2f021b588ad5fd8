// A robot as its URDF or SDF file describes it, in plain values: links with their solids and looks, joints,
// and what the file holds that is not simulated. Reading is model_xml.cc (checks, with lines) and
// robot_model.cc (sdformat).
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "server/scene/collada_reader.h"
#include "server/scene/inertia.h"
#include "server/world/world_model.h"

namespace visum::scene {

struct RobotShape {
  std::string name;
  std::string link;  // the one in the file that it is of, also after links were joined
  world::ShapeKind kind = world::ShapeKind::kBox;
  std::array<double, 3> size{};  // as in world::Shape; of a plane that does not collide its two sides
  std::filesystem::path mesh;    // resolved
  std::size_t mesh_part = 0;     // of a mesh in RobotModel::converted
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  world::Pose X_LS;
  bool collides = true;
  std::optional<std::array<double, 4>> color;
};

struct RobotLink {
  std::string name;
  int line = 0;            // in the model's file; 0: unknown
  MassProperties mass;     // in the link's frame; mass 0: the file gives none
  world::Pose X_ML;        // in the model, all joints at 0
  bool on_ground = false;  // fixed to the world by the model itself
  // False: it never collides with others of its kind in the same (nested) model, unless the scene says so.
  bool self_collides = true;
  std::vector<RobotShape> shapes;
};

struct RobotJoint {
  world::Joint joint;  // name as in the file; the ids of parent and child are not set
  std::string parent;  // "world": the world
  std::string child;
  int line = 0;
};

// A link that moves with another one as one body, because a fixed joint connects them.
struct JoinedLink {
  std::string name;
  std::string into;
  world::Pose X_IL;  // I: the link that it was joined into
};

struct RobotModel {
  std::filesystem::path file;
  std::vector<RobotLink> links;    // in the order of the file
  std::vector<RobotJoint> joints;  // in the order of the file; none is fixed once joined
  std::vector<JoinedLink> joined;
  std::map<std::filesystem::path, ColladaMesh> converted;  // meshes that are here already, by their file
  std::vector<std::string> losses;  // what is not shown or not simulated, one sentence each
  std::vector<std::string> notes;   // what was read otherwise than it stands there, at no loss
};

inline constexpr const char* kWorldLink = "world";

// Throws ConfigError at the place in the model's file that is wrong. Never uses a network; prints nothing.
RobotModel read_robot_model(const std::filesystem::path& file, const std::string& text);

// Joins links over fixed joints: masses, shapes and joints move to the upper link's frame.
void join_links(RobotModel& model);

// A visual shape of the same form and place as a colliding one gives it its colour and goes; colliding shapes
// without a visual are not drawn (alpha 0) on links that have visuals. Other visual planes become thin boxes.
void match_visuals(RobotLink& link);

}  // namespace visum::scene

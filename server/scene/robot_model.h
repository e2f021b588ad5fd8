// A robot as its URDF, SDF or MJCF file describes it, in plain values: links with their solids and looks,
// joints, and a list of what is not simulated. urdf_robot.cc reads URDF, sdf_robot.cc SDF, and mjcf/ MJCF.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/scene/collada_reader.h"
#include "server/scene/inertia.h"
#include "server/scene/model_xml.h"
#include "server/scene/packages.h"
#include "server/scene/remark.h"
#include "server/world/world_model.h"

namespace visum::scene {

struct RobotShape {
  std::string name;
  std::string link;  // the link in the file, also after links were joined
  world::ShapeKind kind = world::ShapeKind::kBox;
  std::array<double, 3> size{};  // as in world::Shape; for a plane that does not collide, its two sides
  std::filesystem::path mesh;    // the resolved path
  std::size_t mesh_part = 0;     // index into the parts of a mesh in RobotModel::converted
  Eigen::Vector3d scale = Eigen::Vector3d::Ones();
  world::Pose X_LS;
  bool collides = true;
  std::optional<std::array<double, 4>> color;
  ModelSurface surface = {};  // as far as the file says it
};

struct RobotLink {
  std::string name;
  int line = 0;            // in `file`; 0: unknown
  std::string file = {};   // which the model's file includes; empty: the model's file itself
  MassProperties mass;     // in the link's frame; mass 0: the file gives none
  world::Pose X_ML;        // in the model's frame, with all joints at 0
  bool on_ground = false;  // the model itself fixes it to the world
  // False: it never collides with other such links of the same (nested) model, unless the scene says so.
  bool self_collides = true;
  std::vector<RobotShape> shapes;
};

// A joint moves as another one does: its position is multiplier * q + offset.
struct Mimic {
  std::string leader;  // the other joint, by its name in the file
  double multiplier = 1.0, offset = 0.0;
  int line = 0;
};

struct RobotJoint {
  world::Joint joint;  // named as in the file; the ids of parent and child are not set
  std::string parent;  // "world" for the world
  std::string child;
  int line = 0;
  std::string file = {};     // as RobotLink::file
  bool closes_loop = false;  // fixed ones are kept, too
  double initial = 0.0;      // position at the start; the nearest one within the limits is taken
  double maximum_speed = 0.0, maximum_effort = 0.0;  // 0: the file gives none
  double stiffness = 0.0, rest = 0.0;                // of a spring about or along its axis; 0: there is none
  std::optional<Mimic> mimic = {};
};

// A link that is one body with another one, because a fixed joint connects them.
struct JoinedLink {
  std::string name;
  std::string into;
  world::Pose X_IL;  // I: the link that it was joined into
};

struct RobotModel {
  std::filesystem::path file;
  std::vector<RobotLink> links;    // in the order of the file
  std::vector<RobotJoint> joints;  // in the order of the file; after join_links() none is fixed
  std::vector<JoinedLink> joined;
  std::map<std::filesystem::path, ColladaMesh> converted;     // meshes that are read already, by their file
  std::map<std::filesystem::path, world::TriangleMesh> seen;  // STL and OBJ of looks, read already
  std::vector<Remark> losses;                                 // things that are not shown or not simulated
  std::vector<Remark> repairs;     // things that the file gives in a way that no solid has
  std::vector<std::string> notes;  // things that are read in another way than the file says, without a loss
  std::vector<std::string> actuated;  // joints with an actuator, by name; empty: the file names none
  std::vector<std::pair<std::string, std::string>> no_collision;  // links that the file keeps apart
  // True: links that hang on no joint move unless they are `on_ground`. False: the scene says it.
  bool says_what_is_fixed = false;
  // Meshes of moving links collide as their hulls, unless the scene says otherwise.
  bool collides_by_hulls = false;
  std::optional<Eigen::Vector3d> gravity;  // for a scene of this model alone
  std::optional<ModelWorld> world;  // the file holds a <world>; links and joints are named "model::link"
};

inline constexpr const char* kWorldLink = "world";

// Throws ConfigError at the wrong place of the model's file; ModelErrors if there are several. Uses no
// network and prints nothing.
RobotModel read_robot_model(const std::filesystem::path& file, const std::string& text,
                            const Packages& packages = {});

// True if the root element is <mujoco>. read_mjcf() reads such a file, and all that it includes. Both are in
// mjcf/reader.cc. Throws as read_robot_model(), which calls it.
bool is_mjcf(std::string_view text);
RobotModel read_mjcf(const std::filesystem::path& file, const std::string& text, const Packages& packages);

// Joins links over fixed joints: masses, shapes and joints move to the upper link's frame.
void join_links(RobotModel& model);

// The names of the models of a world's file, in its order.
std::vector<std::string> models_of_world(const RobotModel& world);
// One of them, with names as in its own file. Remarks stay with the world. Call it after join_links().
RobotModel one_of_world(const RobotModel& world, const std::string& model);

// Merges looks with solids. A visual shape of the same form and place as a colliding one gives it its colour
// and is removed. On links with visuals, colliding shapes without one are not drawn (alpha 0). Visual planes
// that remain become thin boxes.
void match_visuals(RobotLink& link);

}  // namespace visum::scene

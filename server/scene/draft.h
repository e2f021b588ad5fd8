// A scene while it is being read: the world so far, and what only its readers need (which names are taken,
// meshes that were read already, links that were joined into others). The loader owns it for the time of one
// load. Every function throws ConfigError at the place of the value that is wrong.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "server/scene/scene.h"

namespace visum::scene {

struct RobotModel;

// A name of the scene that stands for a body or for a place on one: the link "palm" that was joined into
// "link_7".
struct LinkFrame {
  world::BodyId body;
  world::Pose X_BL;  // L: the link's own frame
};

class Draft {
 public:
  explicit Draft(Scene& scene);

  Scene& scene;
  std::vector<config::Node> part_entries;     // parts are made last, when the joints have their final order
  std::map<std::string, world::Pose> frames;  // X_WF by name
  std::map<std::string, std::shared_ptr<const RobotModel>> robots;  // by file: read once, placed often
  std::vector<std::filesystem::path> plugin_folders;                // see plugin::open_library
  bool refuses_plugins = false;
  // Limits of joints that belong to drives, by the joint's name in the scene.
  struct DriveLimit {
    double speed = 0.0, effort = 0.0;  // 0: none given
  };
  std::map<std::string, DriveLimit> drive_limits;
  struct Follower {
    std::string leader;  // the joint that it follows, by its name in the scene
    double multiplier = 1.0, offset = 0.0;
  };
  std::map<std::string, Follower> followers;  // by the joint's name in the scene
  Packages packages;                          // of the models' meshes
  std::string engine_option;                  // Options::engine: replaces that of every engine
  bool is_spawned = false;      // a file that comes into a world that runs: it brings things, and no settings
  bool world_settings = false;  // gravity and step are those of a world's file
  std::optional<world::Pose> X_WO;  // O: origin of the file that is being read; none: W itself

  // Takes a name for a body, joint, model, part or surface (`what`); fails at `place` if it is taken already.
  void claim(const std::string& what, const std::string& name, const config::Place& place);

  // By name in the scene, else fails at `node`, naming the nearest.
  world::SurfaceId surface(const config::Node& node) const;
  // The surface of these values. Adds it, named after them, if there is none.
  world::SurfaceId surface_like(const world::Surface& values, const config::Place& place);
  // True if the engine of this number is `impulse`, of Visum: it has springs and screws, and moves joints by
  // the mean of a tick's speeds.
  bool is_impulse(std::int32_t engine) const;
  std::int32_t material(const config::Node& node) const;
  std::int32_t engine(const config::Node& node) const;
  world::Pose frame(const config::Node& node) const;
  LinkFrame link(const config::Node& node, const std::string& prefix = "") const;  // prefix: "arm/"

  // The body that a link or body of this name is, or was joined into; invalid if there is none.
  world::BodyId body(const std::string& name) const;
  // True for what was in the scene before this draft.
  bool is_old(world::BodyId body) const { return body.valid() && body.index() < old_bodies_; }
  bool is_old(world::JointId joint) const { return joint.index() < old_joints_; }
  void add_link_name(const std::string& name, const LinkFrame& frame) { links_[name] = frame; }

  // Appends; fails at `place` if the world is full or world::fault_of finds something in it.
  world::BodyId add_body(const world::Body& body, const config::Place& place);
  void add_shape(const world::Shape& shape, const config::Place& place);
  void add_joint(const world::Joint& joint, const config::Place& place);
  void forbid_collision(world::BodyId a, world::BodyId b);

  // Reads a mesh once per file and scale; the triangles of all meshes together stay within kMaxTriangles.
  // `known`, if it is not null, is what the file holds.
  world::MeshId mesh(const std::filesystem::path& file, const Eigen::Vector3d& scale,
                     const config::Place& wanted_by, const world::TriangleMesh* known = nullptr);
  // The same for a part of a file that was converted: `mesh`, once per name and scale.
  world::MeshId converted_mesh(const std::string& name, const world::TriangleMesh& mesh,
                               const Eigen::Vector3d& scale, const config::Place& wanted_by);
  // The hull of a mesh of this scene, thinned out where it has many vertices. Invalid for a flat mesh.
  world::MeshId hull_of(world::MeshId mesh, const config::Place& wanted_by);

 private:
  std::map<std::string, config::Place> names_;  // "body 'box'" -> where
  std::map<std::string, LinkFrame> links_;
  world::MeshId add_mesh(world::TriangleMesh mesh, const Eigen::Vector3d& scale,
                         const config::Place& wanted_by);

  std::map<std::tuple<std::string, double, double, double>, world::MeshId> meshes_;
  std::size_t triangles_ = 0;
  const std::size_t old_bodies_, old_joints_;
};

inline constexpr std::size_t kMaxEngines = 16;
inline constexpr std::size_t kMaxSurfaces = 1000;
inline constexpr const char* kMainEngine = "default";  // name of world.engines[0]

}  // namespace visum::scene

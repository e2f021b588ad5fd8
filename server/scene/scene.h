// A scene: the description of a world, read from a YAML file, with the models (URDF, SDF) and meshes that it
// names. Everything is checked here, before the first tick. An error throws ConfigError with file, line and
// key. server/scene/README.md describes the format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "hwparts/part.h"
#include "protocol/config/config.h"
#include "protocol/plugin/library.h"
#include "server/scene/clock.h"
#include "server/scene/looks.h"
#include "server/scene/packages.h"
#include "server/scene/remark.h"
#include "server/world/world_model.h"

namespace visum::scene {

// A robot of the scene, as its entry describes it. Its links and joints are in `world`.
struct ModelPlan {
  std::string name;
  config::Node config;
  world::Pose X_WM;
  std::string file = {};  // URDF or SDF
  // Pairs of its links that overlap at the start never collide (cycle/start_overlaps.h finds them).
  bool overlaps_never_collide = false;
};

// A part of the scene, not yet made: hwparts::make_part(kind, context) makes it.
struct PartPlan {
  std::string kind;
  hwparts::PartContext context;
  std::vector<world::JointId> joints;  // the joints of `context`, by their ids in the world
};

// A joint that follows another one of its model (a URDF's <mimic>): it goes to multiplier * q + offset, where
// q is the other joint's position. cycle/follow.h says how.
struct FollowerPlan {
  world::JointId joint, leader;
  double multiplier = 1.0, offset = 0.0;
  double maximum_speed = 0.0, maximum_effort = 0.0;  // 0: the model gives none
};

// A sensor of the scene, not yet made: its place, and its entry for those who make it.
struct SensorPlan {
  std::string name;
  std::string kind;
  config::Node config;
  world::BodyId body;    // invalid: it stands in the world
  world::Pose X_BS;      // the sensor's frame on its body, or in W
  world::JointId joint;  // for sensors that measure a joint; otherwise invalid
};

// An agent of the scene, not yet made.
struct AgentPlan {
  std::string name;
  const plugin::AgentKind* kind;
  config::Node config;
  std::int64_t period_ns = 0;
  // The agent's name for each part, and the part's number: first the scene's parts, then its sensors.
  std::vector<std::pair<std::string, std::size_t>> parts;
};

// A model that came while the world ran: the names of all that its file brought.
struct Spawned {
  std::string name;
  std::vector<std::string> models, bodies, joints, parts, sensors, losses;
};

// A remark about a file that the scene names.
struct FileRemark {
  std::string file;
  Remark remark;
};

// A checked scene. The caller owns it.
struct Scene {
  std::string name;
  std::filesystem::path file;
  world::WorldModel world;
  std::vector<std::string> engine_names{"default"};     // the scene's names for world.engines
  std::vector<config::Place> engine_places;             // where the scene sets them; empty: an option did
  std::map<std::size_t, config::Node> plugged_engines;  // entries of engines that plug-ins bring, by number
  std::vector<ModelPlan> models;
  std::vector<PartPlan> parts;
  std::vector<FollowerPlan> followers;  // without those that a part drives
  std::vector<SensorPlan> sensors;
  std::vector<plugin::Library> plugins;  // their kinds are looked up before the built-in ones
  std::vector<AgentPlan> agents;
  std::vector<Spawned> spawned;  // in the order in which they came; what they brought stands behind the rest
  Packages packages;             // where its files, and those of models that come later, look for others
  Looks looks;
  ClockKind clock = ClockKind::kRealtime;
  double speed = 1.0;  // realtime: simulated seconds per second of wall time, kLeastSpeed to kMostSpeed
  std::uint64_t seed = 1;
  std::int64_t lockstep_timeout_ns = 10'000'000'000;
  std::vector<std::string> losses;   // things of a model that are not shown or simulated, one sentence each
  std::vector<FileRemark> warnings;  // the losses once more, with their places
  std::vector<FileRemark> repairs;   // what was changed in a model so that it can move; they are losses, too
  std::vector<std::string> notes;    // things that are read in another way than the file says, without a loss
};

struct Options {
  std::string engine;  // --engine: replaces every engine of the scene; empty: as the scene says
  std::vector<std::filesystem::path> plugin_folders;  // where plug-ins may come from
  std::string parameters;  // --parameters: values of the file's parameters, a YAML map; empty: its defaults
  Packages packages;       // of the models' meshes; the environment's are added
  bool refuses_plugins = false;  // a scene that names plug-ins is refused
};

// Throws ConfigError at the first thing that is wrong.
Scene load_scene(const std::filesystem::path& file, const Options& options = {});

// Limits of the text of an added body, checked before it is parsed. Far above what a body with the most
// shapes needs; one of these limits is parsed within about a second.
inline constexpr std::size_t kMaxBodyBytes = std::size_t{1} << 20;
inline constexpr std::size_t kMaxBodyValues = 100'000;  // counted as config::most_values() does
// Why a text is too long for an added body; empty: it is not.
std::string too_long_for_body(std::string_view yaml);

// Reads one entry of `bodies:` from a text (the request AddBody) and appends it to the world. If it is wrong,
// throws ConfigError and changes nothing.
void add_body(Scene& scene, const std::string& yaml);

}  // namespace visum::scene

// A scene: the description of a world, read from a YAML file, with the models (URDF, SDF) and meshes that it
// names. Everything is checked here, before the first tick; what is wrong throws ConfigError with file, line
// and key. The format is described in server/scene/README.md. sdformat stays inside robot_model.cc.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "hwparts/part.h"
#include "protocol/config/config.h"
#include "protocol/plugin/library.h"
#include "server/scene/clock.h"
#include "server/scene/looks.h"
#include "server/world/world_model.h"

namespace visum::scene {

// A robot of the scene, as its entry says. Its links and joints are in the world.
struct ModelPlan {
  std::string name;
  config::Node config;
  world::Pose X_WM;
};

// A part of the scene, not yet made: hwparts::make_part(kind, context) makes it.
struct PartPlan {
  std::string kind;
  hwparts::PartContext context;
  std::vector<world::JointId> joints;  // where context.joints stand in the world
};

// A sensor of the scene, not yet made: where it sits, and its entry for those who make it.
struct SensorPlan {
  std::string name;
  std::string kind;
  config::Node config;
  world::BodyId body;    // invalid: it stands in the world
  world::Pose X_BS;      // the sensor's frame on its body, or in W
  world::JointId joint;  // of those that measure one; else invalid
};

// An agent of the scene, not yet made.
struct AgentPlan {
  std::string name;
  const plugin::AgentKind* kind;
  config::Node config;
  std::int64_t period_ns = 0;
  // What the agent calls each part, and its number: the scene's parts, then its sensors.
  std::vector<std::pair<std::string, std::size_t>> parts;
};

struct Scene {
  std::string name;
  std::filesystem::path file;
  world::WorldModel world;
  std::vector<std::string> engine_names{"default"};     // how the scene calls world.engines
  std::vector<config::Place> engine_places;             // where it says so; empty: an option did
  std::map<std::size_t, config::Node> plugged_engines;  // entries of those that plug-ins bring, by number
  std::vector<ModelPlan> models;
  std::vector<PartPlan> parts;
  std::vector<SensorPlan> sensors;
  std::vector<plugin::Library> plugins;  // their kinds count before those that are built in
  std::vector<AgentPlan> agents;
  Looks looks;
  ClockKind clock = ClockKind::kRealtime;
  double speed = 1.0;  // realtime: simulated seconds per second of wall time, kLeastSpeed to kMostSpeed
  std::uint64_t seed = 1;
  std::int64_t lockstep_timeout_ns = 10'000'000'000;
  std::vector<std::string> losses;  // what a model holds and we do not show or simulate, one sentence each
  std::vector<std::string> notes;   // what was read otherwise than it stands there, at no loss
};

struct Options {
  std::string engine;  // --engine: replaces every engine of the scene; empty: as the scene says
  std::vector<std::filesystem::path> plugin_folders;  // where plug-ins may come from
  std::string parameters;  // --parameters: values of the file's parameters, a YAML map; empty: its defaults
};

Scene load_scene(const std::filesystem::path& file, const Options& options = {});

// One entry of `bodies:` from text, for AddBody. Appends to the world; throws ConfigError and changes nothing
// if wrong.
void add_body(Scene& scene, const std::string& yaml);

}  // namespace visum::scene

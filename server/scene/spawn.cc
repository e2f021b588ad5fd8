#include "server/scene/spawn.h"

#include <algorithm>
#include <set>

#include "protocol/config/config.h"
#include "server/scene/bare_model.h"
#include "server/scene/joints.h"
#include "server/scene/parts.h"
#include "server/scene/sensors.h"
#include "server/scene/values.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;
using config::ConfigError;
using config::Node;

// How much there was before, to find what came.
struct Sizes {
  explicit Sizes(const Scene& scene)
      : models(scene.models.size()),
        bodies(scene.world.bodies.size()),
        joints(scene.world.joints.size()),
        parts(scene.parts.size()),
        sensors(scene.sensors.size()),
        losses(scene.losses.size()),
        warnings(scene.warnings.size()),
        repairs(scene.repairs.size()),
        notes(scene.notes.size()) {}
  std::size_t models, bodies, joints, parts, sensors, losses, warnings, repairs, notes;
};

template <typename List, typename Name>
std::vector<std::string> names_from(const List& list, std::size_t first, const Name& name) {
  std::vector<std::string> names;
  for (std::size_t i = first; i < list.size(); ++i) names.push_back(name(list[i]));
  return names;
}

std::set<std::string> taken_names(const Scene& scene) {
  std::set<std::string> taken;
  for (const Spawned& model : scene.spawned) taken.insert(model.name);
  for (const ModelPlan& model : scene.models) taken.insert(model.name);
  for (const PartPlan& part : scene.parts) taken.insert(part.context.name);
  for (const SensorPlan& sensor : scene.sensors) taken.insert(sensor.name);
  for (const AgentPlan& agent : scene.agents) taken.insert(agent.name);
  for (const world::Body& body : scene.world.bodies) taken.insert(body.name);
  return taken;
}

// The first of NAME, NAME_2, NAME_3, ... that is free; it ends, since there are fewer names than numbers.
std::string unique_name(const Scene& scene, const std::string& name) {
  const auto taken = taken_names(scene);
  std::string unique = name;
  for (std::size_t number = 2; taken.contains(unique); ++number) unique = name + "_" + std::to_string(number);
  return unique;
}

std::string checked_name(const Scene& scene, const SpawnOrder& order, const std::string& of_file,
                         const config::Place& place) {
  const std::string& wanted = order.name.empty() ? of_file : order.name;
  const std::string name = order.make_unique ? unique_name(scene, wanted) : wanted;
  if (const auto fault = name_fault(name); !fault.empty())
    throw ConfigError(place, "'" + name + "': a model's name " + fault);
  if (taken_names(scene).contains(name))
    throw ConfigError(place, "the name '" + name + "' is taken: choose another, or ask for a unique one");
  return name;
}

std::string checked_name(const std::vector<Spawned>& spawned, const std::string& name,
                         const config::Place& place) {
  if (std::ranges::find(spawned, name, &Spawned::name) != spawned.end())
    throw ConfigError(place, "the name '" + name + "' is taken: it can be spawned once");
  return name;
}

// Returns the name that the model got.
std::string read_scene_file(Draft& draft, const SpawnOrder& order, const config::Place& place) {
  const Node root = config::load_file(order.file);
  if (!can_be_spawned(root)) {
    const std::string name = name_of_model_file(order.file);
    if (!order.name.empty() && order.name != name)
      throw ConfigError(place, "has no parameter 'name': it can be spawned as '" + name + "' only");
    read_spawned_file(draft, order.file, {});
    return checked_name(draft.scene.spawned, name, place);
  }
  const Node usual = root.get("parameters").get("name");
  const std::string of_file =
      usual.kind() == Node::Kind::kScalar ? usual.text() : name_of_model_file(order.file);
  const std::string name = checked_name(draft.scene, order, of_file, place);
  read_spawned_file(draft, order.file, config::load_text("{name: " + yaml_quoted(name) + "}", "the request"));
  return name;
}

// It stands for itself, so that it can go again at any time.
void refuse_ties(const Draft& draft, const Sizes& before, const config::Place& place) {
  const auto& world = draft.scene.world;
  for (std::size_t i = before.joints; i < world.joints.size(); ++i) {
    const auto& joint = world.joints[i];
    if (draft.is_old(joint.child) || draft.is_old(joint.parent))
      throw ConfigError(place, "joint '" + joint.name + "' would hold a body that was there before");
  }
  for (std::size_t i = before.sensors; i < draft.scene.sensors.size(); ++i) {
    const auto& sensor = draft.scene.sensors[i];
    if (draft.is_old(sensor.body) || (sensor.joint.valid() && draft.is_old(sensor.joint)))
      sensor.config.fail("is about something that was there before");
    if (plugin::find_sensor(draft.scene.plugins, sensor.kind))
      sensor.config.fail("is of a plug-in's kind, which cannot be spawned");
  }
  for (std::size_t i = before.parts; i < draft.scene.parts.size(); ++i) {
    const auto& part = draft.scene.parts[i];
    if (const auto bus = part.context.config.find("bus"))
      bus->fail("cannot be spawned: field buses are opened when the server starts");
    if (plugin::find_part(draft.scene.plugins, part.kind))
      part.context.config.fail("is of a plug-in's kind, which cannot be spawned");
  }
}

void refuse_too_many(const Scene& scene, const Spawned& came, const config::Place& place) {
  const auto fail = [&](const char* what, std::size_t most) {
    throw ConfigError(place, std::string("more than ") + std::to_string(most) + " " + what);
  };
  if (came.bodies.empty() && came.parts.empty() && came.sensors.empty())
    throw ConfigError(place, "brings nothing");
  if (came.bodies.size() > kMaxSpawnedBodies) fail("bodies in one model", kMaxSpawnedBodies);
  if (scene.spawned.size() >= kMaxSpawned) fail("models were spawned", kMaxSpawned);
  std::size_t parts = came.parts.size() + came.sensors.size();
  for (const Spawned& other : scene.spawned) parts += other.parts.size() + other.sensors.size();
  if (parts > kMaxSpawnedParts) fail("parts and sensors of spawned models", kMaxSpawnedParts);
}

}  // namespace

bool can_be_spawned(const Node& root) {
  if (root.kind() != Node::Kind::kMap || !root.find("visum")) return false;
  const auto parameters = root.find("parameters");
  return parameters && parameters->kind() == Node::Kind::kMap && parameters->find("name").has_value();
}

void spawn(Scene& scene, const SpawnOrder& order) {
  const config::Place place{order.file.string(), 0, ""};
  const Sizes before(scene);
  Draft draft(scene);
  draft.is_spawned = true;
  draft.packages = scene.packages;
  draft.X_WO = order.X_WM;
  Spawned came;
  if (is_model_file(order.file)) {
    came.name = checked_name(scene, order, name_of_model_file(order.file), place);
    place_bare_model(draft, order.file, came.name);
  } else {
    came.name = read_scene_file(draft, order, place);
  }
  sort_world(draft, place);
  plan_parts(draft);
  find_measured_joints(draft);
  refuse_ties(draft, before, place);
  if (const auto fault = world::find_fault(scene.world); !fault.empty()) throw ConfigError(place, fault);
  came.models = names_from(scene.models, before.models, [](const auto& model) { return model.name; });
  came.bodies = names_from(scene.world.bodies, before.bodies, [](const auto& body) { return body.name; });
  came.joints = names_from(scene.world.joints, before.joints, [](const auto& joint) { return joint.name; });
  came.parts = names_from(scene.parts, before.parts, [](const auto& part) { return part.context.name; });
  came.sensors = names_from(scene.sensors, before.sensors, [](const auto& sensor) { return sensor.name; });
  came.losses = names_from(scene.losses, before.losses, [](const auto& loss) { return loss; });
  refuse_too_many(scene, came, place);
  scene.warnings.resize(before.warnings);
  scene.repairs.resize(before.repairs);
  scene.notes.resize(before.notes);
  scene.spawned.push_back(std::move(came));
}

}  // namespace visum::scene

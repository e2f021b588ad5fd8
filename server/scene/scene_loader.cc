#include <functional>
#include <optional>
#include <utility>

#include "protocol/config/expand.h"
#include "server/scene/bodies.h"
#include "server/scene/draft.h"
#include "server/scene/frames.h"
#include "server/scene/includes.h"
#include "server/scene/joints.h"
#include "server/scene/models.h"
#include "server/scene/parts.h"
#include "server/scene/read_looks.h"
#include "server/scene/sensors.h"
#include "server/scene/settings.h"
#include "server/scene/values.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;
using config::Node;

constexpr std::int64_t kVersion = 1;

void check_header(const Node& root) {
  // Whatever file this is, its text is nobody's business.
  if (root.kind() == Node::Kind::kScalar) root.fail("must be a map, is a text");
  root.allow_only({"visum",        "name",    "gravity",    "tick_ms",
                   "clock",        "speed",   "seed",       "lockstep_timeout_s",
                   "engine",       "engines", "include",    "surfaces",
                   "materials",    "models",  "bodies",     "joints",
                   "no_collision", "parts",   "lights",     "viewpoints",
                   "panels",       "frames",  "parameters", "sensors"});
  const Node version = root.get("visum");
  if (version.integer(1) > kVersion)
    version.fail("this is version " + version.text() + " of the format, only version 1 is known here");
}

// Calls `read` for each entry of a list that may be missing.
void each(const Node& root, const char* key, const std::function<void(const Node&)>& read) {
  const auto list = root.find(key);
  if (!list) return;
  for (std::size_t i = 0; i < list->size(); ++i) read(list->at(i));
}

class Loader {
 public:
  explicit Loader(Draft& draft) : draft_(draft) {}

  // `given`: values for the file's parameters; `asked_by`: the entry that includes the file.
  void read_file(const fs::path& file, const std::optional<Node>& given, const Node* asked_by) {
    const Node text = includes_.open(file);
    check_header(text);
    const auto variables = read_parameters(text, given, asked_by, budget_);
    read_root(config::expanded(text, variables, budget_));
    includes_.close();
  }

 private:
  // What is included comes first: it may be built upon, and its settings may be replaced. It may stand in the
  // frames of the file that includes it, so those come before.
  void read_root(const Node& root) {
    each(root, "frames", [&](const Node& entry) { read_frame(draft_, entry); });
    each(root, "include", [&](const Node& entry) { include(entry); });
    read_settings(draft_, root);
    read_engines(draft_, root);
    read_surfaces(draft_, root);
    read_materials(draft_, root);
    each(root, "models", [&](const Node& entry) { read_model(draft_, entry); });
    each(root, "bodies", [&](const Node& entry) { read_body(draft_, entry); });
    each(root, "joints", [&](const Node& entry) { read_joint(draft_, entry); });
    if (const auto pairs = root.find("no_collision")) read_no_collision(draft_, *pairs, "");
    each(root, "parts", [&](const Node& entry) { draft_.part_entries.push_back(entry); });
    each(root, "sensors", [&](const Node& entry) { read_sensor(draft_, entry); });
    each(root, "lights", [&](const Node& entry) { read_light(draft_, entry); });
    each(root, "viewpoints", [&](const Node& entry) { read_viewpoint(draft_, entry); });
    each(root, "panels", [&](const Node& entry) { read_panel(draft_, entry); });
  }

  void include(const Node& entry) {
    const IncludeEntry wanted = read_include(draft_, entry);
    includes_.check(wanted.file, entry);
    const auto outer = std::exchange(draft_.X_WO, wanted.X_WO);
    try {
      read_file(wanted.file, wanted.parameters, &entry);
    } catch (const config::ConfigError& error) {
      throw told_where(error, wanted.file, entry);
    }
    draft_.X_WO = outer;
  }

  Draft& draft_;
  Includes includes_;
  config::ExpansionBudget budget_;
};

void apply(const Options& options, Scene& scene) {
  if (options.engine.empty()) return;
  for (world::EngineSetting& engine : scene.world.engines) engine.name = options.engine;
  scene.engine_places.clear();
}

void refuse_fault(const Scene& scene, const config::Place& place) {
  if (const std::string fault = world::find_fault(scene.world); !fault.empty())
    throw config::ConfigError(place, fault);
}

Scene empty_scene(const fs::path& file) {
  Scene scene;
  scene.file = file;
  scene.name = file.stem().string();
  scene.world.engines.push_back({"ode"});
  scene.engine_places.push_back({file.string(), 0, "engine"});
  scene.world.surfaces.push_back({"default"});
  return scene;
}

// How large a world was, to go back to.
struct Sizes {
  explicit Sizes(const world::WorldModel& w)
      : bodies(w.bodies.size()), shapes(w.shapes.size()), meshes(w.meshes.size()) {}
  void restore(world::WorldModel& w) const {
    w.bodies.resize(bodies);
    w.shapes.resize(shapes);
    w.meshes.resize(meshes);
  }
  std::size_t bodies, shapes, meshes;
};

}  // namespace

Scene load_scene(const fs::path& file, const Options& options) {
  Scene scene = empty_scene(file);
  Draft draft(scene);
  Loader(draft).read_file(file, std::nullopt, nullptr);
  const config::Place whole{file.string(), 0, ""};
  sort_world(draft, whole);
  plan_parts(draft);
  find_measured_joints(draft);
  apply(options, scene);
  scene.world.name = scene.name;
  refuse_fault(scene, whole);
  return scene;
}

void add_body(Scene& scene, const std::string& yaml) {
  const Sizes before(scene.world);
  const Node entry = config::load_text(yaml, "added body", scene.file.parent_path());
  try {
    Draft draft(scene);
    read_body(draft, entry);
    refuse_fault(scene, entry.place());
  } catch (...) {
    before.restore(scene.world);
    throw;
  }
}

}  // namespace visum::scene

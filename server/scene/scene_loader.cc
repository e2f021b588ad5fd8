#include <algorithm>
#include <functional>
#include <system_error>

#include "server/scene/bodies.h"
#include "server/scene/draft.h"
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
constexpr std::size_t kMaxIncludeDepth = 16;
constexpr int kMaxFiles = 256;  // files that include others twice each would double at every level

void check_header(const Node& root) {
  root.allow_only({"visum",        "name",    "gravity", "tick_ms",
                   "clock",        "speed",   "seed",    "lockstep_timeout_s",
                   "engine",       "engines", "include", "surfaces",
                   "materials",    "models",  "bodies",  "joints",
                   "no_collision", "parts",   "lights",  "viewpoints",
                   "panels",       "sensors"});
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

  void read_file(const fs::path& file) { read_root(config::load_file(file), file); }

 private:
  // What is included comes first: it may be built upon, and its settings may be replaced.
  void read_root(const Node& root, const fs::path& file) {
    check_header(root);
    chain_.push_back(fs::weakly_canonical(file));
    each(root, "include", [&](const Node& entry) { include(entry); });
    chain_.pop_back();
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
    const fs::path file = read_path(entry);
    std::error_code error;
    const fs::path canonical = fs::weakly_canonical(file, error);
    if (std::find(chain_.begin(), chain_.end(), canonical) != chain_.end()) fail_cycle(entry, canonical);
    if (chain_.size() == kMaxIncludeDepth)
      entry.fail("files include each other more than " + std::to_string(kMaxIncludeDepth) + " levels deep");
    if (++files_ > kMaxFiles) entry.fail("more than " + std::to_string(kMaxFiles) + " files are included");
    if (!fs::exists(file, error)) entry.fail("'" + file.string() + "': no such file");
    read_file(file);
  }

  [[noreturn]] void fail_cycle(const Node& entry, const fs::path& again) const {
    std::string chain;
    for (const fs::path& file : chain_) chain += file.filename().string() + " -> ";
    entry.fail("files include each other in a circle: " + chain + again.filename().string());
  }

  Draft& draft_;
  std::vector<fs::path> chain_;  // the files that are being read, each included by the one before
  int files_ = 0;
};

void apply(const Options& options, Scene& scene) {
  if (options.engine.empty()) return;
  for (world::EngineSetting& engine : scene.world.engines) engine.name = options.engine;
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
  Loader(draft).read_file(file);
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

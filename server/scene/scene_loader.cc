#include <functional>
#include <optional>
#include <utility>

#include "protocol/config/expand.h"
#include "server/scene/all_errors.h"
#include "server/scene/bare_model.h"
#include "server/scene/bodies.h"
#include "server/scene/draft.h"
#include "server/scene/frames.h"
#include "server/scene/includes.h"
#include "server/scene/joints.h"
#include "server/scene/model_errors.h"
#include "server/scene/models.h"
#include "server/scene/parts.h"
#include "server/scene/plugins.h"
#include "server/scene/read_looks.h"
#include "server/scene/sensors.h"
#include "server/scene/settings.h"
#include "server/scene/spawn.h"
#include "server/scene/values.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;
using config::Node;

constexpr std::int64_t kVersion = 1;
constexpr const char* kAddedBody = "added body";  // in place of a file's name

void check_header(const Node& root) {
  // The message does not quote the text: the file may be anything, even a secret.
  if (root.kind() == Node::Kind::kScalar) root.fail("must be a map, is a text");
  root.allow_only({"visum",        "name",    "gravity",    "tick_ms",
                   "clock",        "speed",   "seed",       "lockstep_timeout_s",
                   "engine",       "engines", "include",    "surfaces",
                   "materials",    "models",  "bodies",     "joints",
                   "no_collision", "parts",   "lights",     "viewpoints",
                   "panels",       "frames",  "parameters", "sensors",
                   "plugins",      "agents",  "collision"});
  const Node version = root.get("visum");
  if (version.integer(1) > kVersion)
    version.fail("this is version " + version.text() + " of the format, only version 1 is known here");
}

// Collects what is wrong with a scene: throws the first error at once, or keeps all of them.
class Complaints {
 public:
  explicit Complaints(std::vector<config::ConfigError>* kept) : kept_(kept) {}

  // Reads an entry. If that fails, its name counts as gone.
  void attempt(const std::optional<Node>& entry, const std::function<void()>& read) {
    if (!kept_) return read();
    try {
      read();
    } catch (const ModelErrors& errors) {
      for (const config::ConfigError& error : errors.all()) keep(error, entry);
    } catch (const config::ConfigError& error) {
      keep(error, entry);
    }
  }

  std::size_t count() const { return kept_ ? kept_->size() : 0; }
  // Ends the reading if errors came since `count`: too much is missing, and further errors would only follow
  // from that.
  void end_if_more_than(std::size_t count) {
    if (this->count() <= count) return;
    const config::ConfigError last = kept_->back();
    kept_->pop_back();
    throw last;
  }
  // Errors from number `first` on lie in an included file.
  void tell_where(std::size_t first, const fs::path& file, const Node& entry) {
    for (std::size_t i = first; i < count(); ++i) (*kept_)[i] = told_where((*kept_)[i], file, entry);
  }

 private:
  void keep(const config::ConfigError& error, const std::optional<Node>& entry) {
    if (!follows(error) && !told(error) && kept_->size() < kMaxErrors) kept_->push_back(error);
    if (const auto name = entry ? name_of(*entry) : std::nullopt) gone_.push_back("'" + *name);
  }
  // True if the error is about a name ("'arm'", "'arm/link_3'") that is missing because its own entry is
  // wrong.
  bool follows(const config::ConfigError& error) const {
    if (!error.message().starts_with("there is no ")) return false;
    for (const std::string& name : gone_)
      if (error.message().find(name + "'") != std::string::npos ||
          error.message().find(name + "/") != std::string::npos)
        return true;
    return false;
  }
  // True if the same error is known already: a repeated entry is wrong each time.
  bool told(const config::ConfigError& error) const {
    for (const config::ConfigError& known : *kept_)
      if (known.place().file == error.place().file && known.place().line == error.place().line &&
          known.message() == error.message())
        return true;
    return false;
  }
  static std::optional<std::string> name_of(const Node& entry) {
    if (entry.kind() != Node::Kind::kMap) return {};
    const auto name = entry.find("name");
    if (!name || name->kind() != Node::Kind::kScalar) return {};
    return name->text();
  }

  std::vector<config::ConfigError>* kept_;  // null: throw at once
  std::vector<std::string> gone_;
};

// A model that comes into a world that runs changes nothing else in it.
void refuse_settings(const Node& root) {
  for (const char* key : {"gravity", "tick_ms", "clock", "speed", "seed", "lockstep_timeout_s", "engine",
                          "engines", "collision", "plugins", "agents", "lights", "viewpoints", "panels"})
    if (const auto node = root.find(key))
      node->fail("is for scenes: a model that is spawned cannot bring it");
  if (const auto surfaces = root.find("surfaces"))
    if (const auto usual = surfaces->find("default"))
      usual->fail("is the scene's: a model that is spawned cannot set it");
}

std::optional<Node> given_parameters(const Options& options) {
  if (options.parameters.empty()) return {};
  const Node given = config::load_text(options.parameters, "--parameters");
  if (given.kind() != Node::Kind::kMap) given.fail("must be a map, as {mass: 2}");
  return given;
}

class Loader {
 public:
  Loader(Draft& draft, std::vector<config::ConfigError>* errors) : draft_(draft), complaints_(errors) {}

  // Reads a scene, or a model without one.
  void read(const fs::path& file, const Options& options) {
    if (!is_model_file(file)) return read_file(file, given_parameters(options), nullptr);
    complaints_.attempt({}, [&] { read_bare_model(draft_, file); });
  }

  // `given`: values for the file's parameters. `asked_by`: the entry that includes the file.
  void read_file(const fs::path& file, const std::optional<Node>& given, const Node* asked_by) {
    const Node text = includes_.open(file);
    check_header(text);
    const auto variables = read_parameters(text, given, asked_by, budget_);
    read_root(config::expanded(text, variables, budget_));
    includes_.close();
  }

 private:
  // Calls `read` for each entry of a list. The list may be missing.
  void each(const Node& root, const char* key, const std::function<void(const Node&)>& read) {
    const auto list = root.find(key);
    if (!list) return;
    for (std::size_t i = 0; i < list->size(); ++i) {
      const Node entry = list->at(i);
      complaints_.attempt(entry, [&] { read(entry); });
    }
  }

  // Includes are read first, because the file may build on them and replace their settings. Frames come even
  // before, because an included file may stand in one.
  void read_root(const Node& root) {
    if (draft_.is_spawned) refuse_settings(root);
    const std::size_t before = complaints_.count();
    each(root, "frames", [&](const Node& entry) { read_frame(draft_, entry); });
    each(root, "include", [&](const Node& entry) {
      complaints_.end_if_more_than(before);
      include(entry);
    });
    complaints_.end_if_more_than(before);
    each(root, "plugins", [&](const Node& entry) { read_plugin(draft_, entry); });
    for (const auto read : {read_settings, read_engines, read_surfaces, read_materials})
      if (!draft_.is_spawned || (read != read_settings && read != read_engines))
        complaints_.attempt({}, [&] { read(draft_, root); });
    complaints_.end_if_more_than(before);
    each(root, "models", [&](const Node& entry) { read_model(draft_, entry); });
    each(root, "bodies", [&](const Node& entry) { read_body(draft_, entry); });
    each(root, "joints", [&](const Node& entry) { read_joint(draft_, entry); });
    if (const auto pairs = root.find("no_collision")) read_no_collision(draft_, *pairs, "");
    each(root, "parts", [&](const Node& entry) { draft_.part_entries.push_back(entry); });
    each(root, "sensors", [&](const Node& entry) { read_sensor(draft_, entry); });
    each(root, "agents", [&](const Node& entry) { read_agent(draft_, entry); });
    each(root, "lights", [&](const Node& entry) { read_light(draft_, entry); });
    each(root, "viewpoints", [&](const Node& entry) { read_viewpoint(draft_, entry); });
    each(root, "panels", [&](const Node& entry) { read_panel(draft_, entry); });
  }

  // Reads an included file, placed where the entry says. Its errors also name the entry.
  void include(const Node& entry) {
    const IncludeEntry wanted = read_include(draft_, entry);
    includes_.check(wanted.file, entry);
    const auto outer = std::exchange(draft_.X_WO, wanted.X_WO);
    const std::size_t before = complaints_.count();
    try {
      read_file(wanted.file, wanted.parameters, &entry);
    } catch (const config::ConfigError& error) {
      draft_.X_WO = outer;
      complaints_.tell_where(before, wanted.file, entry);
      throw told_where(error, wanted.file, entry);
    }
    complaints_.tell_where(before, wanted.file, entry);
    draft_.X_WO = outer;
  }

  Draft& draft_;
  Complaints complaints_;
  Includes includes_;
  config::ExpansionBudget budget_;
};

void apply(const Options& options, Scene& scene) {
  if (options.engine.empty()) return;
  for (world::EngineSetting& engine : scene.world.engines) engine.name = options.engine;
  scene.engine_places.clear();
  scene.plugged_engines.clear();
}

void refuse_fault(const Scene& scene, const config::Place& place) {
  if (const std::string fault = world::find_fault(scene.world); !fault.empty())
    throw config::ConfigError(place, fault);
}

Scene empty_scene(const fs::path& file) {
  Scene scene;
  scene.file = file;
  scene.name = file.stem().string();
  scene.world.engines.push_back({"impulse"});
  scene.engine_places.push_back({file.string(), 0, "engine"});
  scene.world.surfaces.push_back({"default"});
  return scene;
}

// The size of a world, to return to it.
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

// The steps that need the whole world.
void finish(Draft& draft, const Options& options) {
  Scene& scene = draft.scene;
  const config::Place whole{scene.file.string(), 0, ""};
  sort_world(draft, whole);
  plan_parts(draft);
  find_measured_joints(draft);
  find_parts_of_agents(draft);
  apply(options, scene);
  scene.world.name = scene.name;
  refuse_fault(scene, whole);
}

}  // namespace

Scene load_scene(const fs::path& file, const Options& options) {
  Scene scene = empty_scene(file);
  Draft draft(scene);
  draft.plugin_folders = options.plugin_folders;
  draft.refuses_plugins = options.refuses_plugins;
  draft.packages = scene.packages = with_environment(options.packages);
  draft.engine_option = options.engine;
  Loader(draft, nullptr).read(file, options);
  finish(draft, options);
  return scene;
}

std::optional<Scene> load_scene(const fs::path& file, const Options& options,
                                std::vector<config::ConfigError>& errors) {
  Scene scene = empty_scene(file);
  Draft draft(scene);
  draft.plugin_folders = options.plugin_folders;
  draft.refuses_plugins = options.refuses_plugins;
  draft.packages = scene.packages = with_environment(options.packages);
  draft.engine_option = options.engine;
  try {
    Loader(draft, &errors).read(file, options);
    if (errors.empty()) finish(draft, options);
  } catch (const config::ConfigError& error) {
    errors.push_back(error);
  }
  return errors.empty() ? std::optional(std::move(scene)) : std::nullopt;
}

void read_spawned_file(Draft& draft, const fs::path& file, const std::optional<Node>& parameters) {
  Loader(draft, nullptr).read_file(file, parameters, nullptr);
}

std::string too_long_for_body(std::string_view yaml) {
  if (yaml.size() > kMaxBodyBytes)
    return "has " + std::to_string(yaml.size()) + " bytes, an added body has at most " +
           std::to_string(kMaxBodyBytes);
  if (config::most_values(yaml) > kMaxBodyValues)
    return "has more than " + std::to_string(kMaxBodyValues) +
           " values, counted by the marks that stand before them: , : [ { -";
  return {};
}

void add_body(Scene& scene, const std::string& yaml) {
  if (const auto fault = too_long_for_body(yaml); !fault.empty())
    throw config::ConfigError({kAddedBody, 0, ""}, fault);
  const Sizes before(scene.world);
  const Node entry = config::load_text(yaml, kAddedBody, scene.file.parent_path());
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

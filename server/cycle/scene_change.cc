#include "server/cycle/scene_change.h"

#include <stdexcept>
#include <utility>

#include "server/cycle/attempt.h"
#include "server/cycle/simulation.h"
#include "server/scene/convert/convert.h"

namespace visum::cycle {
namespace {

recording::LoadedScene described(const SceneOrder& order, const scene::Scene& scene) {
  recording::LoadedScene loaded;
  const auto key_of = [](const std::filesystem::path& path) {
    return std::filesystem::absolute(path).lexically_normal().string();
  };
  loaded.name = scene.name;
  loaded.file = key_of(order.file);
  loaded.engine = order.engine;
  loaded.seed = scene.seed;
  for (const auto& [name, folder] : order.packages.given) loaded.packages.emplace_back(name, key_of(folder));
  for (const auto& folder : order.packages.folders) loaded.package_folders.push_back(key_of(folder));
  return loaded;
}

// The clock, the pace and the threads belong to the program that runs the world, and stay.
scene::Scene read(const std::filesystem::path& file, const scene::Options& options,
                  const scene::Scene& before) {
  auto scene = scene::load_any(file, options);
  const auto tick_ns = scene.world.tick_ns, tick_before_ns = before.world.tick_ns;
  if (tick_ns != tick_before_ns)
    throw std::runtime_error("the scene '" + scene.name + "' has ticks of " + std::to_string(tick_ns) +
                             " ns, this server runs with " + std::to_string(tick_before_ns) +
                             " ns: start a server with that scene");
  scene.clock = before.clock;
  scene.speed = before.speed;
  for (auto& engine : scene.world.engines) engine.threads = before.world.engines.front().threads;
  return scene;
}

scene::Scene read_recorded(const recording::LoadedScene& loaded, const scene::Scene& before) {
  scene::Options options{loaded.engine, {}, loaded.parameters, {}};
  for (const auto& [name, folder] : loaded.packages) options.packages.given[name] = folder;
  options.packages.folders.assign(loaded.package_folders.begin(), loaded.package_folders.end());
  auto scene = read(loaded.file, options, before);
  scene.seed = loaded.seed;
  return scene;
}

void check_files(const config::Files& files) {
  std::size_t bytes = 0;
  for (const auto& [path, content] : files) bytes += path.size() + content.size();
  if (bytes > SceneChange::kMostFileBytes)
    throw std::runtime_error("the files of the scene have " + std::to_string(bytes) +
                             " bytes, one that is loaded into a running server has at most " +
                             std::to_string(SceneChange::kMostFileBytes));
}

}  // namespace

SceneChange::SceneChange() = default;
SceneChange::~SceneChange() = default;
SceneChange::SceneChange(SceneChange&&) noexcept = default;
SceneChange& SceneChange::operator=(SceneChange&&) noexcept = default;

Outcome prepare(SceneChange& change) {
  const auto& before = *change.scene;
  // Objects of plug-ins are made, called and destroyed on the tick's thread alone.
  if (!before.plugins.empty())
    return {Refusal::kWrongState, "the scene '" + before.name +
                                      "' uses plug-ins, so no other scene can take its place: start a "
                                      "server with that scene"};
  return attempt(Refusal::kBadValue, [&] {
    if (change.loaded) {
      const config::FilesGiven files(change.loaded->files);
      change.world = make_unstarted(read_recorded(*change.loaded, before), change.make);
    } else {
      config::FilesNoted noted;
      scene::Options options{change.order.engine, {}, {}, change.order.packages};
      options.refuses_plugins = true;
      auto scene = read(change.order.file, options, before);
      if (change.order.seed) scene.seed = *change.order.seed;
      auto loaded = described(change.order, scene);
      change.world = make_unstarted(std::move(scene), change.make);
      check_files(noted.files);
      loaded.files = std::move(noted.files);
      change.loaded = std::make_shared<const recording::LoadedScene>(std::move(loaded));
    }
    if (const auto count = change.world->parts().size(); count > SceneChange::kMostParts)
      throw std::runtime_error("the scene has " + std::to_string(count) +
                               " parts, sensors and agents, one that is loaded has at most " +
                               std::to_string(SceneChange::kMostParts));
  });
}

}  // namespace visum::cycle

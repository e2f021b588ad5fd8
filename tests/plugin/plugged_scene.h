// Scenes with the plug-ins of this folder.
#pragma once

#include <string>

#include "server/cycle/simulation.h"
#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

namespace visum::test {

inline scene::Options plugin_options() {
  scene::Options options;
  options.plugin_folders = {VISUM_TEST_PLUGINS, VISUM_PLUGINS};
  return options;
}

// The scene of the arm in models/, with `yaml` added.
inline scene::Scene scene_with_arm(const std::string& yaml) {
  const TempFiles files;
  const auto arm = std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml";
  return scene::load_scene(files.write("s.yaml", "visum: 1\ninclude: ['" + arm.string() + "']\n" + yaml),
                           plugin_options());
}

// A scene that consists of `yaml` alone.
inline scene::Scene scene_of(const std::string& yaml, const std::string& engine = "") {
  const TempFiles files;
  auto options = plugin_options();
  options.engine = engine;
  return scene::load_scene(files.write("s.yaml", "visum: 1\n" + yaml), options);
}

// The error of a scene that consists of `yaml` alone, as a user sees it; "no error" if there is none.
inline std::string error_of_scene(const std::string& yaml) {
  const TempFiles files;
  const auto file = files.write("s.yaml", "visum: 1\n" + yaml);
  return files.error_of([&] { cycle::Simulation(scene::load_scene(file, plugin_options())); });
}

inline cycle::BoundPart& part_of(cycle::Simulation& simulation, const std::string& name) {
  for (auto& bound : simulation.parts())
    if (bound.part->description().name == name) return bound;
  throw std::runtime_error("no part " + name);
}

inline double output_of(cycle::Simulation& simulation, const std::string& part, const std::string& port) {
  auto& bound = part_of(simulation, part);
  const auto& ports = bound.part->description().sensor_outputs;
  for (std::size_t i = 0; i < ports.size(); ++i)
    if (ports[i].name == port) return bound.sensor_outputs[i];
  throw std::runtime_error("no port " + port);
}

inline void run(cycle::Simulation& simulation, int ticks) {
  for (int i = 0; i < ticks; ++i) simulation.tick();
}

}  // namespace visum::test

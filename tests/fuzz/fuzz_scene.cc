// Any text as a scene, and as a model that comes into a world that runs; a text that begins with '<' as the
// URDF or SDF of a model. It is read, or refused with a ConfigError that names a place. No other file exists.
#include <spdlog/spdlog.h>

#include <cstdio>
#include <cstdlib>

#include "protocol/config/read_file.h"
#include "server/scene/scene.h"
#include "server/scene/spawn.h"

namespace {

using namespace visum;

void load(const config::Files& files) {
  const config::FilesGiven given(files);
  try {
    scene::load_scene("/fuzz/scene.yaml");
  } catch (const config::ConfigError& error) {
    if (!error.place().file.empty()) return;
    std::fprintf(stderr, "an error without a place: %s\n", error.what());
    std::abort();
  }
}

// Spawns a model: everything that was there before must stay as it was, whatever comes.
void spawn(const config::Files& files, const std::string& file) {
  static const scene::Scene base = [] {
    const config::Files only{
        {"/fuzz/base.yaml",
         "visum: 1\nengine: impulse\nbodies:\n- {name: floor, fixed: true, shapes: [{plane: true}]}\n"
         "- {name: box, mass: 1, shapes: [{sphere: 1}]}\n"}};
    const config::FilesGiven given(only);
    return scene::load_scene("/fuzz/base.yaml");
  }();
  const config::FilesGiven given(files);
  scene::Scene changed = base;
  try {
    scene::spawn(changed, {file, "it", {}, true});
  } catch (const config::ConfigError& error) {
    if (!error.place().file.empty()) return;
    std::fprintf(stderr, "an error without a place: %s\n", error.what());
    std::abort();
  }
  const bool kept = changed.world.bodies[0].name == "floor" && changed.world.bodies[1].name == "box" &&
                    changed.world.gravity == base.world.gravity && changed.spawned.size() == 1 &&
                    changed.spawned[0].bodies.size() + 2 == changed.world.bodies.size();
  if (!kept) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool quiet = (spdlog::set_level(spdlog::level::off), true);
  static_cast<void>(quiet);
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (!text.starts_with('<')) {
    load({{"/fuzz/scene.yaml", text}});
    spawn({{"/fuzz/model.yaml", text}}, "/fuzz/model.yaml");
    return 0;
  }
  for (const std::string file : {"robot.urdf", "robot.sdf"}) {
    load({{"/fuzz/scene.yaml", "visum: 1\nmodels: [{name: robot, file: " + file + "}]\n"},
          {"/fuzz/" + file, text}});
    spawn({{"/fuzz/" + file, text}}, "/fuzz/" + file);
  }
  return 0;
}

// Any text as a scene; a text that begins with '<' as the URDF or SDF of a model in one. It is read, or
// refused with a ConfigError that names a place. No other file exists.
#include <spdlog/spdlog.h>

#include <cstdio>
#include <cstdlib>

#include "protocol/config/read_file.h"
#include "server/scene/scene.h"

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

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool quiet = (spdlog::set_level(spdlog::level::off), true);
  static_cast<void>(quiet);
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (!text.starts_with('<')) {
    load({{"/fuzz/scene.yaml", text}});
    return 0;
  }
  for (const std::string file : {"robot.urdf", "robot.sdf"})
    load({{"/fuzz/scene.yaml", "visum: 1\nmodels: [{name: robot, file: " + file + "}]\n"},
          {"/fuzz/" + file, text}});
  return 0;
}

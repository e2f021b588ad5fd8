// Every scene that we ship loads without an error.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "server/scene/scene.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;

TEST(Models, EveryShippedSceneLoads) {
  std::vector<fs::path> scenes;
  for (const auto& entry : fs::directory_iterator(fs::path(VISUM_SOURCE_DIR) / "models/scenes"))
    if (entry.path().extension() == ".yaml") scenes.push_back(entry.path());
  std::sort(scenes.begin(), scenes.end());
  ASSERT_FALSE(scenes.empty());
  Options options;
  options.plugin_folders = plugin::plugin_folders({});  // the installed ones
  for (const fs::path& file : scenes) {
    SCOPED_TRACE(file.string());
    EXPECT_NO_THROW({
      const Scene scene = load_scene(file, options);
      EXPECT_EQ(world::find_fault(scene.world), "");
      EXPECT_FALSE(scene.world.bodies.empty());
    });
  }
}

// Reading does not depend on pointers, hashes or the time: two readings give the same world.
TEST(Models, TheArmsSceneIsReadTheSameTwice) {
  const fs::path file = fs::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml";
  const Scene a = load_scene(file), b = load_scene(file);
  ASSERT_EQ(a.world.bodies.size(), b.world.bodies.size());
  for (std::size_t i = 0; i < a.world.bodies.size(); ++i) {
    EXPECT_EQ(a.world.bodies[i].name, b.world.bodies[i].name);
    EXPECT_EQ(a.world.bodies[i].X_WB.p, b.world.bodies[i].X_WB.p);
    EXPECT_EQ(a.world.bodies[i].inertia_C, b.world.bodies[i].inertia_C);
  }
  ASSERT_EQ(a.world.joints.size(), 9u);
  for (std::size_t i = 0; i < a.world.joints.size(); ++i)
    EXPECT_EQ(a.world.joints[i].name, b.world.joints[i].name);
}

TEST(Readme, ItsExampleIsTheSceneThatTheTestsLoad) {
  const auto whole = [](const fs::path& file) {
    std::stringstream text;
    text << std::ifstream(fs::path(VISUM_SOURCE_DIR) / file).rdbuf();
    return text.str();
  };
  const std::string example = whole("tests/scene/data/complete.yaml");
  ASSERT_FALSE(example.empty());
  EXPECT_NE(whole("server/scene/README.md").find("```yaml\n" + example + "```"), std::string::npos);
}

}  // namespace
}  // namespace visum::scene

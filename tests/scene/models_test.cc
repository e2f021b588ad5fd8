// Every scene that we ship loads without an error.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

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

// A chain of four links: l0 - l1 - l2 - l3.
std::string chain() {
  std::string xml = "<robot name='r'>";
  for (const char* i : {"0", "1", "2", "3"})
    xml += "<link name='l" + std::string(i) + "'><collision><geometry><sphere radius='0.1'/></geometry>" +
           "</collision></link>";
  for (const auto& [a, b] : {std::pair("0", "1"), std::pair("1", "2"), std::pair("2", "3")})
    xml += "<joint name='j" + std::string(b) + "' type='continuous'><origin xyz='1 0 0'/><parent link='l" +
           a + "'/><child link='l" + b + "'/></joint>";
  return xml + "</robot>";
}

Scene scene_of_chain(const std::string& no_collision) {
  const test::TempFiles files;
  files.write("r.urdf", chain());
  return load_scene(files.write(
      "s.yaml", "visum: 1\nmodels: [{name: r, file: r.urdf, no_collision: " + no_collision + "}]\n"));
}

TEST(Models, LinksWithinNJointsNeverCollide) {
  const auto pair = [](int a, int b) { return std::pair(world::BodyId{a}, world::BodyId{b}); };
  const std::vector direct{pair(0, 1), pair(1, 2), pair(2, 3)};
  EXPECT_EQ(scene_of_chain("{within_joints: 1}").world.no_collision, direct);
  const Scene two = scene_of_chain("{within_joints: 2}");
  EXPECT_EQ(two.world.no_collision,
            (std::vector{pair(0, 1), pair(0, 2), pair(1, 2), pair(1, 3), pair(2, 3)}));
  EXPECT_TRUE(two.repairs.back().remark.text.ends_with("never collide: 2"));
  EXPECT_EQ(scene_of_chain("{within_joints: 3, pairs: [[l0, l3]]}").world.no_collision.size(), 6u);
  EXPECT_THROW(scene_of_chain("{within_joints: 0}"), config::ConfigError);
  EXPECT_THROW(scene_of_chain("{within_joints: 17}"), config::ConfigError);
  EXPECT_THROW(scene_of_chain("{overlap: true}"), config::ConfigError);
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

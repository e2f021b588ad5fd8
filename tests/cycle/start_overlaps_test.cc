#include "server/cycle/start_overlaps.h"

#include <gtest/gtest.h>

#include "server/collision/prepared_meshes.h"
#include "server/cycle/simulation.h"
#include "tests/support/temp_files.h"

namespace visum::cycle {
namespace {

// Three links, one after the other. The tool's box reaches 2 cm into the base's; the arm has no shape.
std::string robot() {
  const auto link = [](const std::string& name, const std::string& z) {
    return "<link name='" + name +
           "'><inertial><mass value='1'/><inertia ixx='0.1' iyy='0.1' izz='0.1' ixy='0' ixz='0' iyz='0'/>"
           "</inertial>" +
           (z.empty() ? std::string()
                      : "<collision><origin xyz='0 0 " + z +
                            "'/><geometry><box size='0.2 0.2 0.2'/></geometry></collision>") +
           "</link>";
  };
  const auto joint = [](const std::string& name, const std::string& parent, const std::string& child) {
    return "<joint name='" + name + "' type='revolute'><parent link='" + parent + "'/><child link='" + child +
           "'/><axis xyz='1 0 0'/><limit lower='-1' upper='1' effort='50' velocity='2'/></joint>";
  };
  return "<robot name='r'>" + link("base", "0.1") + link("arm", "") + link("tool", "0.28") +
         joint("a", "base", "arm") + joint("b", "arm", "tool") + "</robot>";
}

scene::Scene scene_with(const std::string& no_collision) {
  const test::TempFiles files;
  files.write("r.urdf", robot());
  return scene::load_scene(files.write(
      "s.yaml", "visum: 1\nmodels: [{name: r, file: r.urdf, no_collision: " + no_collision + "}]\n"));
}

scene::Scene bare(const std::string& engine) {
  const test::TempFiles files;
  scene::Options options;
  options.engine = engine;
  return scene::load_scene(files.write("r.urdf", robot()), options);
}

TEST(StartOverlaps, AreToldWithTheirDepth) {
  const scene::Scene scene = scene_with("{overlapping: false}");
  collision::PreparedMeshes meshes;
  const auto overlaps = overlaps_at_start(scene.world, meshes);
  ASSERT_EQ(overlaps.size(), 1u);
  EXPECT_EQ(scene.world.bodies[overlaps[0].a.index()].name, "r/base");
  EXPECT_EQ(scene.world.bodies[overlaps[0].b.index()].name, "r/tool");
  EXPECT_NEAR(overlaps[0].depth_m, 0.02, 1e-9);
}

TEST(StartOverlaps, AreKeptUnlessTheModelAsks) {
  const Simulation simulation(scene_with("[]"));
  EXPECT_EQ(overlaps_at_start(simulation.model(), simulation.prepared_meshes()).size(), 1u);
  EXPECT_TRUE(simulation.scene().repairs.empty());
}

TEST(StartOverlaps, AreLeftOutAndReportedIfTheModelAsks) {
  const Simulation simulation(scene_with("{overlapping: true}"));
  EXPECT_TRUE(overlaps_at_start(simulation.model(), simulation.prepared_meshes()).empty());
  EXPECT_EQ(world::find_fault(simulation.model()), "");
  ASSERT_EQ(simulation.scene().repairs.size(), 1u);
  EXPECT_EQ(simulation.scene().repairs[0].remark.text,
            "model 'r': links that overlap at the start never collide: 'r/base' and 'r/tool' (0.02 m)");
}

TEST(StartOverlaps, OfTwoModelsStay) {
  const test::TempFiles files;
  files.write("r.urdf", robot());
  const Simulation simulation(
      scene::load_scene(files.write("s.yaml",
                                    "visum: 1\nmodels: [{name: r, file: r.urdf, no_collision: {overlapping: "
                                    "true}}, {name: s, file: r.urdf, "
                                    "no_collision: {overlapping: true}, pose: {xyz: [0.19, 0, 0]}}]\n")));
  const auto& bodies = simulation.model().bodies;
  const auto overlaps = overlaps_at_start(simulation.model(), simulation.prepared_meshes());
  EXPECT_FALSE(overlaps.empty());
  for (const Overlap& overlap : overlaps)
    EXPECT_NE(bodies[overlap.a.index()].model, bodies[overlap.b.index()].model);
}

class BareRobot : public testing::TestWithParam<const char*> {};

TEST_P(BareRobot, WithLinksThatOverlapRunsAndGivesTheSameBitsTwice) {
  Simulation first(bare(GetParam())), second(bare(GetParam()));
  EXPECT_EQ(first.scene().repairs.size(), 1u);
  EXPECT_TRUE(overlaps_at_start(first.model(), first.prepared_meshes()).empty());
  for (int tick = 0; tick < 1000; ++tick) {
    first.tick();
    second.tick();
  }
  EXPECT_FALSE(first.frozen()) << first.fault();
  EXPECT_EQ(first.state().tick, 1000);
  EXPECT_EQ(first.state_hash(), second.state_hash());
}

INSTANTIATE_TEST_SUITE_P(Engines, BareRobot, testing::Values("ode", "impulse"));

}  // namespace
}  // namespace visum::cycle

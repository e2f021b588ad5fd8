// Scenes are written as SDF worlds, and come back with names, surfaces and springs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/scene/convert/convert.h"
#include "server/world/joint_kinds.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Convert, WritesSdfThatSdfReadersTake) {
  const test::TempFiles files;
  const auto robot = std::filesystem::path(VISUM_SOURCE_DIR) / "tests/scene/data/robot.urdf";
  const auto yaml = files.folder() / "robot.yaml", sdf = files.folder() / "robot.sdf";
  convert(robot, yaml, {});
  EXPECT_EQ(load_scene(yaml).world.joints.size(), read_any_scene(robot, {}).world.joints.size());
  convert(robot, sdf, {});
  EXPECT_THAT(files.read("robot.sdf"), HasSubstr("<joint name=\"shoulder\" type=\"revolute\">"));
}

// A body of the scene as its SDF file gives it back: null where a fixed joint joined it into another one.
const world::Body* read_back(const Scene& again, const world::Body& body) {
  std::string flat = body.name;
  std::ranges::replace(flat, '/', '.');
  for (const std::string& name : {body.name, flat + "/" + flat})
    if (const auto id = again.world.find_body(name); id.valid()) return &again.world.bodies[id.index()];
  return nullptr;
}

TEST(Convert, ShippedScenesComeBackFromSdf) {
  Options options;
  options.plugin_folders = plugin::plugin_folders({});
  std::size_t scenes = 0, moving = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes")) {
    if (entry.path().extension() != ".yaml") continue;
    SCOPED_TRACE(entry.path().filename().string());
    const test::TempFiles files;
    const auto sdf = files.folder() / "scene.sdf";
    convert(entry.path(), sdf, options);
    const Scene from = load_scene(entry.path(), options), again = load_scene(sdf);
    EXPECT_EQ(again.world.tick_ns, from.world.tick_ns);
    EXPECT_EQ(again.world.gravity, from.world.gravity);
    const auto drivable = [](const Scene& scene) {
      return std::ranges::count_if(scene.world.joints,
                                   [](const auto& j) { return world::is_drivable(j.kind); });
    };
    EXPECT_EQ(drivable(again), drivable(from));
    double mass = 0.0, mass_again = 0.0;
    for (const world::Body& body : from.world.bodies) {
      if (!body.fixed) mass += body.mass_kg;
      const world::Body* found = read_back(again, body);
      if (found == nullptr) continue;
      EXPECT_EQ(found->fixed, body.fixed) << body.name;
      EXPECT_TRUE(found->X_WB.p.isApprox(body.X_WB.p, 1e-9) || (found->X_WB.p - body.X_WB.p).norm() < 1e-9);
      EXPECT_LT(found->X_WB.q.angularDistance(body.X_WB.q), 1e-9) << body.name;
    }
    for (const world::Body& body : again.world.bodies)
      if (!body.fixed) mass_again += body.mass_kg, ++moving;
    EXPECT_NEAR(mass_again, mass, 1e-9 * (1 + mass));
    EXPECT_EQ(again.world.shapes.size(), from.world.shapes.size());
    ++scenes;
  }
  EXPECT_GT(scenes, 5u);
  EXPECT_GT(moving, 30u);
}

TEST(Convert, SpringsSurfacesAndNamesComeBackFromSdf) {
  const test::TempFiles files;
  const auto file = files.write("s.yaml", R"(
visum: 1
engine: impulse
surfaces: {ice: {friction: 0.05, restitution: 0.25}}
bodies:
  - {name: a, mass: 1, shapes: [{box: [1, 1, 1], surface: ice}]}
  - {name: b, mass: 1, shapes: [{box: [1, 1, 1]}], pose: {xyz: [0, 0, 2]}}
joints:
  - {name: j, type: hinge, parent: a, child: b, axis: [0, 1, 0]}
  - {name: s, type: torsion_spring, parent: a, child: b, axis: [0, 1, 0], stiffness: 4, rest: 0.5}
  - {name: k, type: screw, child: a, axis: [0, 0, 1], pitch: 0.02}
)");
  convert(file, files.folder() / "s.sdf", {});
  const Scene again = load_scene(files.folder() / "s.sdf");
  EXPECT_EQ(again.world.engines[0].name, "impulse");
  ASSERT_EQ(again.world.joints.size(), 3u);
  const auto joint = [&](const std::string& name) {
    return again.world.joints.at(again.world.find_joint(name).index());
  };
  EXPECT_EQ(joint("a/j_spring").stiffness, 4.0);
  EXPECT_EQ(joint("a/j_spring").rest, 0.5);
  EXPECT_EQ(joint("a/k").pitch_m, 0.02);
  const world::Surface& surface = again.world.surfaces[again.world.shapes.at(0).surface.index()];
  EXPECT_EQ(surface.friction, 0.05);
  EXPECT_EQ(surface.restitution, 0.25);
}

TEST(Convert, SdfSaysWhoCollidesOrThatItCannot) {
  const test::TempFiles files;
  const auto file = files.write("s.yaml", R"(
visum: 1
bodies:
  - {name: a, mass: 1, shapes: [{box: [1, 1, 1], color: [1, 0, 0, 0.25]}]}
  - {name: b, mass: 1, shapes: [{box: [1, 1, 1]}], pose: {xyz: [0, 0, 0.5]}}
  - {name: c, mass: 1, shapes: [{box: [1, 1, 1]}], pose: {xyz: [3, 0, 0]}}
  - {name: d, mass: 1, shapes: [{box: [1, 1, 1]}], pose: {xyz: [5, 0, 0]}}
  - {name: e, mass: 1, shapes: [{box: [1, 1, 1]}], pose: {xyz: [7, 0, 0]}}
joints:
  - {name: j1, type: hinge, parent: c, child: d, axis: [0, 1, 0], limits: [-1, 1], stop_restitution: 0.7}
  - {name: j2, type: hinge, parent: d, child: e, axis: [0, 1, 0]}
no_collision: [[a, b], [a, e]]
)");
  EXPECT_THAT(
      convert(file, files.folder() / "s.sdf", {}),
      ElementsAre("the restitution of the stops of joint 'j1' is not written to SDF",
                  "SDF cannot keep pairs of bodies apart: 'a' and 'b' (and 1 more) can collide there"));
  const std::string text = files.read("s.sdf");
  const auto said = text.find("<self_collide>true</self_collide>");
  EXPECT_GT(said, text.find("<model name=\"c\">"));
  EXPECT_EQ(text.find("<self_collide>", said + 1), std::string::npos)
      << "once: a and b are links by themselves";
  EXPECT_THAT(text, HasSubstr("<diffuse>1 0 0 1</diffuse>")) << "0.25 once, not twice";
  EXPECT_THAT(text, HasSubstr("<transparency>0.75</transparency>"));
}

TEST(Convert, SdfHoldsModelsWhoseLinksNeverCollide) {
  const test::TempFiles files;
  const auto robot = std::filesystem::path(VISUM_SOURCE_DIR) / "tests/scene/data/robot.urdf";
  const auto file = files.write(
      "s.yaml", "visum: 1\nmodels: [{name: arm, self_collision: false, file: '" + robot.string() + "'}]\n");
  EXPECT_THAT(convert(file, files.folder() / "s.sdf", {}),
              testing::Not(testing::Contains(HasSubstr("never collide"))));
  EXPECT_THAT(files.read("s.sdf"), testing::Not(HasSubstr("self_collide")));
}

}  // namespace
}  // namespace visum::scene

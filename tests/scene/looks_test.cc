// The looks of a scene: materials, textures, lights, viewpoints, panels.
#include <gtest/gtest.h>

#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

const std::string kPng = std::string("\x89PNG\r\n\x1a\n", 8) + "rest";

Scene load(const test::TempFiles& files, const std::string& yaml) {
  return load_scene(files.write("s.yaml", "visum: 1\n" + yaml));
}

std::string looks_error(const std::string& yaml) {
  const test::TempFiles files;
  files.write("a.png", kPng);
  files.write("a.txt", "no picture");
  files.write("bad.json", "{\"visum_panel\": 2, \"name\": \"x\", \"widgets\": []}");
  return files.error_of([&] { load(files, yaml); });
}

TEST(Looks, AMaterialBringsItsColourAndItsTextureAlong) {
  const test::TempFiles files;
  files.write("a.png", kPng);
  const auto scene = load(files,
                          "materials:\n"
                          "  wood: {texture: a.png, texture_size: [0.5, 0.25], roughness: 0.8}\n"
                          "  steel: {color: [0.5, 0.6, 0.7], metalness: 1}\n"
                          "bodies:\n"
                          "- {name: t, fixed: true, material: wood, shapes: [{box: [1, 1, 1]},\n"
                          "   {sphere: 1, material: steel}, {sphere: 1, color: [1, 0, 0]}]}\n");
  ASSERT_EQ(scene.looks.materials.size(), 2u);
  EXPECT_EQ(scene.looks.materials[0].texture_size_m, (std::array<double, 2>{0.5, 0.25}));
  ASSERT_EQ(scene.looks.textures.size(), 1u);
  EXPECT_EQ(scene.looks.textures[0].content_type, "image/png");
  EXPECT_EQ(scene.looks.textures[0].bytes, kPng);
  const auto& shapes = scene.world.shapes;
  EXPECT_EQ(shapes[0].material, 0);
  EXPECT_EQ(shapes[0].color, (std::array<double, 4>{1, 1, 1, 1}));
  EXPECT_EQ(shapes[1].material, 1);
  EXPECT_EQ(shapes[1].color, (std::array<double, 4>{0.5, 0.6, 0.7, 1}));
  EXPECT_EQ(shapes[2].material, 0);
  EXPECT_EQ(shapes[2].color, (std::array<double, 4>{1, 0, 0, 1}));
}

TEST(Looks, LightsAndViewpointsAreRead) {
  const test::TempFiles files;
  const auto scene =
      load(files,
           "lights:\n"
           "- {kind: ambient, intensity: 0.5}\n"
           "- {name: lamp, kind: spot, position: [0, 0, 2], direction: [0, 0, -2], angle_deg: 30,\n"
           "   color: [1, 0.5, 0], shadows: true}\n"
           "viewpoints:\n"
           "- {name: front, position: [2, 0, 1], target: [0, 0, 0.5], fov_deg: 60}\n");
  ASSERT_EQ(scene.looks.lights.size(), 2u);
  const Light& lamp = scene.looks.lights[1];
  EXPECT_EQ(lamp.kind, LightKind::kSpot);
  EXPECT_EQ(lamp.direction, Eigen::Vector3d(0, 0, -1));
  EXPECT_NEAR(lamp.angle_rad, 0.5235987755982988, 1e-12);
  EXPECT_TRUE(lamp.shadows);
  ASSERT_EQ(scene.looks.viewpoints.size(), 1u);
  EXPECT_NEAR(scene.looks.viewpoints[0].fov_rad, 1.0471975511965976, 1e-12);
}

TEST(Looks, TheArmsSceneShipsAPanel) {
  const auto scene = load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/amtec_arm.yaml");
  ASSERT_EQ(scene.looks.panels.size(), 1u);
  EXPECT_EQ(scene.looks.panels[0].name, "Jog the arm");
  EXPECT_NE(scene.looks.panels[0].text.find("Desired Angle 7"), std::string::npos);
}

TEST(BadLooks, AreRefusedWithTheirPlace) {
  const std::pair<const char*, const char*> table[] = {
      {"materials: {a: {roughness: 2}}", "s.yaml:2: materials.a.roughness: must be between 0 and 1, is 2"},
      {"materials: {a: {roughnes: 1}}",
       "s.yaml:2: materials.a: unknown key 'roughnes'; did you mean 'roughness'?"},
      {"materials: {a: {texture_size: [1, 1]}}",
       "s.yaml:2: materials.a.texture_size: needs 'texture' beside it"},
      {"materials: {steel: {}}\nbodies: [{name: b, fixed: true, material: stel, shapes: [{sphere: 1}]}]",
       "s.yaml:3: bodies[0].material: there is no material 'stel'; did you mean 'steel'?"},
      {"lights: [{kind: sun}]",
       "s.yaml:2: lights[0].kind: must be one of ambient, directional, point, spot, is 'sun'"},
      {"lights: [{kind: point}]", "s.yaml:2: lights[0]: key 'position' is missing"},
      {"lights: [{kind: ambient, shadows: true}]",
       "s.yaml:2: lights[0].shadows: means nothing for a light of this kind"},
      {"lights: [{kind: directional, direction: [0, 0, 0]}]",
       "s.yaml:2: lights[0].direction: must not be zero"},
      {"viewpoints: [{name: a, position: [1, 0, 0], target: [1, 0, 0]}]",
       "s.yaml:2: viewpoints[0]: 'position' and 'target' must not be the same point"},
  };
  for (const auto& [yaml, message] : table) EXPECT_EQ(looks_error(yaml), message) << yaml;
}

TEST(BadLooks, FilesThatAreNoPicturesOrPanelsAreRefused) {
  EXPECT_NE(looks_error("materials: {a: {texture: a.txt}}").find("is neither a PNG nor a JPEG picture"),
            std::string::npos);
  EXPECT_NE(looks_error("materials: {a: {texture: b.png}}").find("materials.a.texture: '"),
            std::string::npos);
  EXPECT_NE(looks_error("panels: [bad.json]").find("visum_panel: must be"), std::string::npos);
  EXPECT_NE(looks_error("panels: [none.json]").find("panels[0]: '"), std::string::npos);
}

}  // namespace
}  // namespace visum::scene

// Scenes of several pieces: included files with parameters and places, frames, repetition.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::filesystem::path kModels = std::filesystem::path(VISUM_SOURCE_DIR) / "models";

constexpr const char* kPost = R"(visum: 1
parameters:
  name:
  height: 1
  half: ${height / 2}
  color: [1, 0, 0]
frames:
  - {name: "${name}_top", pose: {xyz: [0, 0, "${height}"]}}
bodies:
  - name: ${name}
    fixed: true
    pose: {xyz: [0, 0, "${half}"]}
    shapes: [{box: [0.1, 0.1, "${height}"], color: "${color}"}]
)";

Scene load(const std::string& yaml) {
  const test::TempFiles files;
  files.write("post.yaml", kPost);
  return load_scene(files.write("scene.yaml", "visum: 1\n" + yaml));
}

std::string language_error(const std::string& yaml) {
  const test::TempFiles files;
  files.write("post.yaml", kPost);
  const auto file = files.write("scene.yaml", "visum: 1\n" + yaml);
  return files.error_of([&] { load_scene(file); });
}

const world::Body& body(const Scene& scene, const std::string& name) {
  const world::BodyId id = scene.world.find_body(name);
  if (!id.valid()) throw std::runtime_error("no body " + name);
  return scene.world.bodies[id.index()];
}

std::vector<std::string> names(const Scene& scene) {
  std::vector<std::string> all;
  for (const auto& each : scene.world.bodies) all.push_back(each.name);
  return all;
}

TEST(SceneLanguage, ParametersOfTheFirstFileComeFromTheOptions) {
  const test::TempFiles files;
  const auto file = files.write("post.yaml", kPost);
  Options options;
  options.parameters = "{name: a, height: 3}";
  EXPECT_EQ(body(load_scene(file, options), "a").X_WB.p[2], 1.5);
  options.parameters = "{name: a, hight: 3}";
  EXPECT_EQ(files.error_of([&] { load_scene(file, options); }),
            "--parameters:1: unknown key 'hight'; did you mean 'height'?");
  options.parameters = "[1]";
  EXPECT_EQ(files.error_of([&] { load_scene(file, options); }),
            "--parameters:1: must be a map, as {mass: 2}");
  options.parameters = "{name: a}";
  const auto none = files.write("none.yaml", "visum: 1");
  EXPECT_THAT(files.error_of([&] { load_scene(none, options); }), HasSubstr("has no parameters"));
}

TEST(SceneLanguage, ParametersHaveDefaultsThatMayBuildOnEachOther) {
  const Scene scene = load("include: [{file: post.yaml, parameters: {name: a, height: 3}}]");
  EXPECT_EQ(body(scene, "a").X_WB.p[2], 1.5);
  EXPECT_EQ(scene.world.shapes[0].size[2], 3.0);
  EXPECT_EQ(scene.world.shapes[0].color[0], 1.0);
}

TEST(SceneLanguage, AFileMayBeIncludedOftenWithOtherValues) {
  const Scene scene = load(
      "include:\n- {file: post.yaml, parameters: {name: a}}\n"
      "- {file: post.yaml, parameters: {name: b, color: [0, 0, 1]}}");
  EXPECT_THAT(names(scene), ElementsAre("a", "b"));
  EXPECT_EQ(scene.world.shapes[1].color[2], 1.0);
}

TEST(SceneLanguage, AnIncludedFileStandsWhereItIsPut) {
  const Scene scene = load(
      "include: [{file: post.yaml, parameters: {name: a}, pose: {xyz: [1, 2, 0], rpy: [0, 0, "
      "1.5707963267948966]}}]");
  EXPECT_TRUE(body(scene, "a").X_WB.p.isApprox(Eigen::Vector3d(1, 2, 0.5)));
  EXPECT_NEAR(body(scene, "a").X_WB.q.angularDistance(Eigen::Quaterniond::Identity()), std::numbers::pi / 2,
              1e-12);
}

TEST(SceneLanguage, PlacesOfIncludesAddUp) {
  const test::TempFiles files;
  files.write("post.yaml", kPost);
  files.write(
      "row.yaml",
      "visum: 1\nbodies: [{name: free, mass: 1, velocity: {linear: [1, 0, 0]}, shapes: [{sphere: 1}]}]\n"
      "include: [{file: post.yaml, parameters: {name: a}, pose: {xyz: [1, 0, 0]}}]");
  const Scene scene = load_scene(files.write(
      "scene.yaml",
      "visum: 1\ninclude: [{file: row.yaml, pose: {xyz: [0, 5, 0], rpy: [0, 0, 1.5707963267948966]}}]\n"
      "bodies: [{name: here, fixed: true}]"));
  EXPECT_TRUE(body(scene, "a").X_WB.p.isApprox(Eigen::Vector3d(0, 6, 0.5)));
  EXPECT_TRUE(body(scene, "free").v_WB.isApprox(Eigen::Vector3d(0, 1, 0)));
  EXPECT_EQ(body(scene, "here").X_WB.p, Eigen::Vector3d::Zero());
}

TEST(SceneLanguage, PosesCanBeGivenInNamedFrames) {
  const Scene scene = load(
      "frames:\n- {name: dock, pose: {xyz: [2, 0, 0], rpy: [0, 0, 1.5707963267948966]}}\n"
      "- {name: slot, pose: {in: dock, xyz: [1, 0, 0]}}\n"
      "include: [{file: post.yaml, parameters: {name: post}, pose: {in: slot}}]\n"
      "bodies:\n- {name: a, fixed: true, pose: {in: slot, xyz: [0, 1, 0]}}\n"
      "- {name: b, fixed: true, pose: {in: post_top}}");
  EXPECT_TRUE(body(scene, "a").X_WB.p.isApprox(Eigen::Vector3d(1, 1, 0)));
  EXPECT_TRUE(body(scene, "b").X_WB.p.isApprox(Eigen::Vector3d(2, 1, 1)));
}

TEST(SceneLanguage, BodiesAndShapesCanBeRepeated) {
  const Scene scene = load(
      "bodies:\n- name: stone_${row}_${column}\n  fixed: true\n  repeat: {row: 2, column: 2}\n"
      "  pose: {xyz: ['${column}', '${row}', 0]}\n"
      "  shapes: [{sphere: 0.1, repeat: 3, pose: {xyz: [0, 0, '${0.2 * index}']}}]");
  EXPECT_THAT(names(scene), ElementsAre("stone_0_0", "stone_0_1", "stone_1_0", "stone_1_1"));
  EXPECT_EQ(scene.world.shapes.size(), 12u);
  EXPECT_EQ(body(scene, "stone_1_0").X_WB.p, Eigen::Vector3d(0, 1, 0));
}

TEST(SceneLanguage, TheSameSurfaceAndMaterialMayBeSaidTwice) {
  const test::TempFiles files;
  files.write("rubber.yaml",
              "visum: 1\nsurfaces: {rubber: {friction: 1}}\nmaterials: {black: {color: [0, 0, 0]}}");
  const auto load_with = [&](const std::string& more) {
    const auto file = files.write("s.yaml", "visum: 1\ninclude: [rubber.yaml, rubber.yaml]\n" + more);
    return files.error_of([&] { EXPECT_EQ(load_scene(file).world.surfaces.size(), 2u); });
  };
  EXPECT_EQ(load_with(""), "no error");
  EXPECT_EQ(load_with("surfaces: {rubber: {friction: 0.5}}"),
            "s.yaml:3: surfaces.rubber: there is already a surface 'rubber' (rubber.yaml:2)");
  EXPECT_EQ(load_with("materials: {black: {color: [0, 0, 0.1]}}"),
            "s.yaml:3: materials.black: there is already a material 'black' (rubber.yaml:3)");
}

TEST(SceneLanguage, AFleetOfTenCartsIsThreeLines) {
  const Scene scene = load_scene(kModels / "scenes/cart_fleet.yaml");
  ASSERT_EQ(scene.parts.size(), 10u);
  EXPECT_EQ(scene.parts[9].context.name, "cart_9");
  EXPECT_EQ(scene.parts[9].joints.size(), 6u);
  EXPECT_NEAR(body(scene, "cart_9/chassis").X_WB.p[1], 6.3, 1e-12);
  EXPECT_EQ(scene.world.bodies.size(), 1u + 10u * 7u);
}

TEST(SceneLanguage, EachMayHaveAnEngineOfItsOwn) {
  const test::TempFiles files;
  files.write("engines.yaml", "visum: 1\nengines: {other: impulse}");
  const std::string cart = (kModels / "cart/cart.yaml").string();
  const Scene scene =
      load_scene(files.write("s.yaml", "visum: 1\ninclude:\n- engines.yaml\n- {file: " + cart +
                                           ", parameters: {name: a}}\n- {file: " + cart +
                                           ", parameters: {name: b, engine: other}}"));
  EXPECT_EQ(body(scene, "a/chassis").engine, 0);
  EXPECT_EQ(body(scene, "b/chassis").engine, 1);
}

TEST(SceneLanguage, ErrorsInIncludedFilesNameTheEntryThatLedThere) {
  EXPECT_EQ(language_error("include:\n- {file: post.yaml, parameters: {name: a, height: tall}}"),
            "post.yaml:5: parameters.half: 'height' is no number (included from scene.yaml:3)");
  EXPECT_EQ(
      language_error("include:\n- {file: post.yaml, parameters: {name: a, height: -1}}"),
      "post.yaml:13: bodies[0].shapes[0].box[2]: must be greater than 0 and at most 1e+06, is -1 (included "
      "from scene.yaml:3)");
}

TEST(SceneLanguage, ParametersAreChecked) {
  EXPECT_EQ(language_error("include:\n- post.yaml"),
            "scene.yaml:3: include[0]: parameter 'name' is missing, it has no default in post.yaml:3");
  EXPECT_EQ(language_error("include:\n- {file: post.yaml, parameters: {nmae: a}}"),
            "scene.yaml:3: include[0].parameters: unknown key 'nmae'; did you mean 'name'?");
  EXPECT_EQ(language_error("include:\n- {file: post.yaml, parameters: {name: a, color: red}}"),
            "scene.yaml:3: include[0].parameters.color: must be a list, as its default in post.yaml:6");
  EXPECT_EQ(
      language_error("parameters: {name: }"),
      "scene.yaml:2: parameters.name: has no default: give it a value with --parameters, or in the file that "
      "includes this one");
  EXPECT_EQ(language_error("parameters: {1st: 1}"),
            "scene.yaml:2: parameters.1st: '1st' is no name: letters, digits and '_', no digit first");
}

TEST(SceneLanguage, FramesAreChecked) {
  EXPECT_EQ(language_error("frames: [{name: dock}]\nbodies: [{name: a, fixed: true, pose: {in: dokc}}]"),
            "scene.yaml:3: bodies[0].pose.in: there is no frame 'dokc'; did you mean 'dock'?");
  EXPECT_EQ(language_error("frames: [{name: dock}, {name: dock}]"),
            "scene.yaml:2: frames[1]: there is already a frame 'dock' (scene.yaml:2)");
  EXPECT_THAT(language_error("bodies: [{name: a, fixed: true, shapes: [{sphere: 1, pose: {in: dock}}]}]"),
              HasSubstr("shapes[0].pose.in: only things that are placed in the world can stand in a frame"));
}

}  // namespace
}  // namespace visum::scene

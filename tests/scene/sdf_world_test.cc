// SDF files with a <world>, and what they include.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/scene/all_errors.h"
#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string in_world(const std::string& inside) {
  return "<sdf version='1.6'>\n<world name='w'>\n" + inside + "</world></sdf>";
}

std::string ball(const std::string& name, const std::string& more = "") {
  return "<model name='" + name + "'>" + more +
         "<link name='l'><inertial><mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>"
         "</inertial><collision name='c'><geometry><sphere><radius>0.1</radius></sphere></geometry>"
         "</collision></link></model>\n";
}

std::string model_file(const std::string& name, const std::string& more = "") {
  return "<sdf version='1.5'>" + ball(name, more) + "</sdf>";
}

std::vector<std::string> names_of(const Scene& scene) {
  std::vector<std::string> names;
  for (const world::Body& body : scene.world.bodies) names.push_back(body.name);
  return names;
}

const world::Body& body_of(const Scene& scene, const std::string& name) {
  return scene.world.bodies.at(scene.world.find_body(name).index());
}

class SdfWorld : public testing::Test {
 protected:
  Scene bare(const std::string& inside, const Options& options = {}) {
    return load_scene(files.write("w.sdf", in_world(inside)), options);
  }
  std::string error(const std::string& inside) {
    return files.error_of([&] { bare(inside); });
  }
  std::vector<std::string> warnings(const Scene& scene) {
    std::vector<std::string> texts;
    for (const FileRemark& warning : scene.warnings)
      texts.push_back(std::filesystem::path(warning.file).filename().string() + ":" +
                      std::to_string(warning.remark.line) + ": " + warning.remark.text);
    return texts;
  }
  test::TempFiles files;
};

TEST_F(SdfWorld, EachModelIsOneOfTheSceneAndFallsUnlessItIsStatic) {
  const Scene scene = bare(ball("a", "<pose>0 0 3 0 0 0</pose>") + ball("b", "<static>true</static>"));
  EXPECT_THAT(names_of(scene), ElementsAre("a/l", "b/l"));
  EXPECT_FALSE(body_of(scene, "a/l").fixed);
  EXPECT_TRUE(body_of(scene, "b/l").fixed);
  EXPECT_EQ(body_of(scene, "a/l").X_WB.p.z(), 3.0);
  EXPECT_EQ(body_of(scene, "a/l").mass_kg, 2.0);
  ASSERT_EQ(scene.models.size(), 2u);
  EXPECT_EQ(scene.models[1].name, "b");
}

// A square of four bars in the plane x, z. The hinge `left` is given limits in which its zero is not.
TEST_F(SdfWorld, ALoopStaysClosedWhereAJointBeginsBeyondItsLimits) {
  const auto link = [](const std::string& name, const std::string& xyz) {
    return "<link name='" + name + "'><pose>" + xyz +
           " 0 0 "
           "0</pose><inertial><mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia>"
           "</inertial></link>\n";
  };
  const auto hinge = [](const std::string& name, const std::string& parent, const std::string& child,
                        const std::string& limit = "") {
    return "<joint name='" + name + "' type='revolute'><parent>" + parent + "</parent><child>" + child +
           "</child><axis><xyz>0 1 0</xyz>" + limit + "</axis></joint>\n";
  };
  const std::string limit = "<limit><lower>0.5</lower><upper>1</upper></limit>";
  const auto model = [&](const std::string& closing) {
    return "<model name='m'>" + link("a", "0 0 0") + link("b", "1 0 0") + link("c", "1 0 1") +
           hinge("ground", "world", "a") + hinge("left", "a", "b", limit) + hinge("right", "b", "c") +
           closing + "</model>\n";
  };
  const auto left = [](const Scene& scene) { return scene.world.joints.at(1); };

  const Scene chain = bare(model(""));
  EXPECT_EQ(left(chain).name, "m/left");
  EXPECT_EQ(left(chain).initial_position, 0.5);
  EXPECT_THAT(chain.losses, ElementsAre());

  const Scene loop = bare(model(hinge("closing", "c", "a")));
  EXPECT_EQ(left(loop).initial_position, 0.0);
  EXPECT_EQ(left(loop).lower, 0.0);
  EXPECT_EQ(left(loop).upper, 1.0);
  EXPECT_THAT(loop.losses,
              ElementsAre(HasSubstr("joint 'left' begins at 0, outside its limits 0.5 and 1; it closes a "
                                    "loop, so it stays there, and the nearer limit with it")));
}

TEST_F(SdfWorld, GivesGravityAndStep) {
  const Scene scene = bare(
      "<gravity>0 0 -3</gravity><physics type='ode'><max_step_size>0.002</max_step_size>"
      "</physics>" +
      ball("a"));
  EXPECT_EQ(scene.world.gravity, Eigen::Vector3d(0, 0, -3));
  EXPECT_EQ(scene.world.tick_ns, 2'000'000);
  const Scene old = bare(
      "<physics type='ode'><gravity>0 0 -2</gravity><max_step_size>0.5</max_step_size>"
      "</physics>" +
      ball("a"));
  EXPECT_EQ(old.world.gravity, Eigen::Vector3d(0, 0, -2));
  EXPECT_EQ(old.world.tick_ns, 1'000'000);
  EXPECT_THAT(warnings(old), ElementsAre(HasSubstr("the step of 0.5 s is not taken")));
}

TEST_F(SdfWorld, WithoutModelsIsEmpty) {
  EXPECT_TRUE(bare("<gravity>0 0 -3</gravity>").world.bodies.empty());
}

TEST_F(SdfWorld, WhatAUserWouldMissIsAWarningWithItsLine) {
  const Scene scene = bare("<light name='s' type='point'/>\n<plugin name='p' filename='f'/>\n" + ball("a") +
                           "<model name='home'><plugin name='q' filename='f'/></model>\n" + ball("a"));
  EXPECT_THAT(names_of(scene), ElementsAre("a/l", "a_1/l"));
  EXPECT_THAT(
      warnings(scene),
      ElementsAre("w.sdf:4: 1 <plugin> element is not read", "w.sdf:3: 1 <light> element is not read",
                  "w.sdf:6: model 'home' has no link", "w.sdf:7: a model named 'a' is called 'a_1' here"));
}

TEST_F(SdfWorld, FramesAndRelativePosesAreFollowed) {
  const std::string inside =
      "<frame name='f'><pose>1 0 0 0 0 0</pose></frame>"
      "<frame name='g' attached_to='world'><pose relative_to='f'>0 1 0 0 0 0</pose></frame>" +
      ball("a", "<pose relative_to='g'>0 0 1 0 0 0</pose>") +
      ball("b", "<pose relative_to='a'>0 0 1 0 0 0</pose>");
  const Scene scene =
      load_scene(files.write("w.sdf", "<sdf version='1.8'><world name='w'>" + inside + "</world></sdf>"));
  EXPECT_TRUE(body_of(scene, "a/l").X_WB.p.isApprox(Eigen::Vector3d(1, 1, 1)));
  EXPECT_TRUE(body_of(scene, "b/l").X_WB.p.isApprox(Eigen::Vector3d(1, 1, 2)));
}

TEST_F(SdfWorld, InASceneHasTheNameOfItsEntryBeforeAllNames) {
  files.write("w.sdf",
              in_world("<gravity>0 0 -3</gravity>" + ball("a") + ball("b", "<pose>0 1 0 0 0 0</pose>")));
  const Scene scene = load_scene(
      files.write("s.yaml", "visum: 1\nmodels: [{name: hall, file: w.sdf, pose: {xyz: [5, 0, 0]}}]\n"));
  EXPECT_THAT(names_of(scene), ElementsAre("hall/a::l", "hall/b::l"));
  EXPECT_TRUE(body_of(scene, "hall/b::l").X_WB.p.isApprox(Eigen::Vector3d(5, 1, 0)));
  EXPECT_FALSE(body_of(scene, "hall/a::l").fixed);
  EXPECT_EQ(scene.world.gravity.z(), -9.81);
  EXPECT_THAT(warnings(scene), ElementsAre(HasSubstr("<gravity> is not read")));
}

TEST_F(SdfWorld, OneOfItsModelsCanBeChosen) {
  files.write("w.sdf", in_world(ball("a") + ball("b")));
  const auto scene = [&](const std::string& more) {
    return load_scene(
        files.write("s.yaml", "visum: 1\nmodels: [{name: it, file: w.sdf, model: " + more + "}]\n"));
  };
  EXPECT_THAT(names_of(scene("b")), ElementsAre("it/l"));
  EXPECT_TRUE(body_of(scene("b, fixed: true"), "it/l").fixed);
  EXPECT_THAT(files.error_of([&] { scene("c"); }), HasSubstr("there is no model 'c'"));
  files.write("w.sdf", model_file("a"));
  EXPECT_THAT(files.error_of([&] { scene("a"); }), HasSubstr("is for files with a <world>"));
}

TEST_F(SdfWorld, IncludesModelsByFolderFileAndPackage) {
  files.write("pot/model.config",
              "<model><sdf version='1.3'>old.sdf</sdf><sdf version='1.5'>new.sdf</sdf>"
              "<sdf version='1.99'>future.sdf</sdf></model>");
  files.write("pot/new.sdf", model_file("pot", "<pose>0 0 7 0 0 0</pose>"));
  files.write("shelf/lid/model.sdf", model_file("lid"));
  Options options;
  options.packages.given["lid"] = files.folder() / "shelf/lid";
  const Scene scene = bare(
      "<include><uri>model://pot</uri></include>"
      "<include><uri>pot/new.sdf</uri><name>second</name><pose>0 0 1 0 0 0</pose><static>1</static></include>"
      "<include><uri>model://lid</uri></include>",
      options);
  EXPECT_THAT(names_of(scene), ElementsAre("pot/l", "second/l", "lid/l"));
  EXPECT_EQ(body_of(scene, "pot/l").X_WB.p.z(), 7.0) << "its own pose";
  EXPECT_EQ(body_of(scene, "second/l").X_WB.p.z(), 1.0);
  EXPECT_TRUE(body_of(scene, "second/l").fixed);
}

TEST_F(SdfWorld, AnErrorOfAnIncludedFileNamesThatFile) {
  files.write("bad.sdf",
              "<sdf version='1.5'><model name='m'>\n<link name='l'><pose>a</pose></link></model></sdf>");
  EXPECT_THAT(error("<include><uri>bad.sdf</uri></include>"), HasSubstr("bad.sdf:2: link 'l': pose must be"));
}

TEST_F(SdfWorld, AnIncludeThatIsNotThereIsLeftOut) {
  const Scene scene = bare(
      "<include><uri>https://fuel.org/x</uri></include>\n"
      "<include><uri>model://sun</uri></include>\n"
      "<include><uri>model://ground_plane</uri></include>\n" +
      ball("a"));
  EXPECT_THAT(names_of(scene), ElementsAre("ground_plane/link", "a/l"));
  EXPECT_THAT(
      warnings(scene),
      ElementsAre(HasSubstr("w.sdf:3: <include> is left out: 'https://fuel.org/x': nothing is fetched"),
                  "w.sdf:4: <include> is left out: 'model://sun' is a light"));
  ASSERT_EQ(scene.repairs.size(), 1u);
  EXPECT_EQ(scene.repairs[0].remark.line, 5);
  EXPECT_THAT(error("<include><uri>https://fuel.org/x</uri></include>"),
              HasSubstr("has no model that can be read. <include> 'https://fuel.org/x': nothing is fetched"));
}

TEST_F(SdfWorld, IncludesWithoutEndAreRefused) {
  files.write("loop.sdf",
              "<sdf version='1.7'><model name='m'><include><uri>loop.sdf</uri></include></model></sdf>");
  EXPECT_THAT(error("<include><uri>loop.sdf</uri></include>"), HasSubstr("over more than 16 levels"));
  // Each file includes the next twice: 2^14 models of the last one.
  for (int i = 0; i < 14; ++i) {
    const std::string next = "<include><uri>f" + std::to_string(i + 1) + ".sdf</uri>";
    files.write("f" + std::to_string(i) + ".sdf", "<sdf version='1.7'><model name='m'>" + next +
                                                      "</include>" + next +
                                                      "<name>n</name></include></model></sdf>");
  }
  files.write("f14.sdf", model_file("end"));
  EXPECT_THAT(error("<include><uri>f0.sdf</uri></include>"), HasSubstr("more than 100000 XML elements"));
}

TEST_F(SdfWorld, MergedIncludesBelongToTheModel) {
  files.write("part.sdf",
              "<sdf version='1.9'><model name='part'><frame name='f'><pose>0 0 1 0 0 0</pose></frame>"
              "<link name='x'><pose>0 1 0 0 0 0</pose></link><link name='y'><pose relative_to='f'/></link>"
              "<joint name='j' type='revolute'><parent>x</parent><child>y</child><axis>"
              "<xyz expressed_in='__model__'>1 0 0</xyz></axis></joint></model></sdf>");
  const Scene scene = load_scene(files.write(
      "m.sdf",
      "<sdf version='1.9'><model name='m'><link name='base'/><include merge='true'><uri>part.sdf</uri>"
      "<pose>5 0 0 0 0 1.5707963267948966</pose></include><joint name='k' type='fixed'><parent>base</parent>"
      "<child>x</child></joint></model></sdf>"));
  EXPECT_THAT(names_of(scene), ElementsAre("m/base", "m/y", "floor"));
  EXPECT_TRUE(body_of(scene, "m/y").X_WB.p.isApprox(Eigen::Vector3d(5, 0, 1)));
  ASSERT_EQ(scene.world.joints.size(), 1u);
  const Eigen::Vector3d axis_W =
      body_of(scene, "m/y").X_WB.q * (scene.world.joints[0].X_CJ.q * scene.world.joints[0].axis_J);
  EXPECT_TRUE(axis_W.isApprox(Eigen::Vector3d::UnitY(), 1e-9)) << axis_W.transpose();
}

TEST_F(SdfWorld, AxesOfOldIncludedFilesAreInTheModelsFrame) {
  const auto file = [](const std::string& version) {
    return "<sdf version='" + version +
           "'><model name='m'><link name='a'/><link name='b'><pose>0 0 0 0 0 1.5707963267948966</pose></link>"
           "<joint name='j' type='revolute'><parent>a</parent><child>b</child><axis><xyz>1 0 0</xyz>"
           "</axis></joint></model></sdf>";
  };
  const auto axis_of = [&](const std::string& version) -> Eigen::Vector3d {
    files.write("m.sdf", file(version));
    const Scene scene = bare("<include><uri>m.sdf</uri></include>");
    const world::Joint& joint = scene.world.joints.at(0);
    return body_of(scene, "m/b").X_WB.q * (joint.X_CJ.q * joint.axis_J);
  };
  EXPECT_TRUE(axis_of("1.4").isApprox(Eigen::Vector3d::UnitX(), 1e-9));
  EXPECT_TRUE(axis_of("1.6").isApprox(Eigen::Vector3d::UnitY(), 1e-9));
}

TEST_F(SdfWorld, NamesThatLaterVersionsReserveAreChanged) {
  const Scene scene = bare(
      "<model name='m'><link name='world'/><link name='x::y'/><joint name='j' type='revolute'>"
      "<parent>world</parent><child>x::y</child><axis><xyz>0 0 1</xyz></axis></joint></model>");
  EXPECT_THAT(names_of(scene), ElementsAre("m/world_1", "m/x__y"));
  EXPECT_EQ(scene.world.joints.at(0).parent, scene.world.find_body("m/world_1"));
  EXPECT_THAT(warnings(scene), testing::Contains(HasSubstr("link 'world' is called 'world_1' here")));
}

TEST_F(SdfWorld, APartDrivesEachModelWithJoints) {
  const std::string robot =
      "<model name='r'><link name='a'/><link name='b'/><joint name='j' type='revolute'><parent>a</parent>"
      "<child>b</child><axis><xyz>0 0 1</xyz></axis></joint></model>";
  const Scene scene = bare(ball("a") + robot);
  ASSERT_EQ(scene.parts.size(), 1u);
  EXPECT_EQ(scene.parts[0].context.name, "r");
}

}  // namespace
}  // namespace visum::scene

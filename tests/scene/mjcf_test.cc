// MJCF files of our own: what is read, what is lost, and which faults are told where.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "server/scene/all_errors.h"
#include "server/scene/bare_model.h"
#include "server/scene/convert/convert.h"
#include "server/scene/mjcf/document.h"
#include "server/scene/robot_model.h"
#include "server/scene/scene.h"
#include "server/world/world_state.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string body(const std::string& inside) {
  return "<mujoco><worldbody><body name='b'><geom size='0.1'/>" + inside + "</body></worldbody></mujoco>";
}

// Two arms of one hinge each beside a floor; `more` stands behind <worldbody>.
std::string arms(const std::string& more, const std::string& geom = "") {
  return "<mujoco>\n<worldbody><geom name='floor' type='plane' size='1 1 1'/>\n"
         "<body name='a' pos='0 0 1'><joint name='ja' axis='0 1 0'/><geom name='ga' size='0.1' " +
         geom +
         "/></body>\n"
         "<body name='b' pos='1 0 1'><joint name='jb' axis='0 1 0'/><geom name='gb' size='0.1' " +
         geom +
         "/></body>\n"
         "</worldbody>\n" +
         more + "</mujoco>";
}

RobotModel read(const std::string& text) {
  const test::TempFiles files;
  return read_robot_model(files.write("m.xml", text), text);
}

std::string error_of(const std::string& text) {
  const test::TempFiles files;
  const auto file = files.write("m.xml", text);
  try {
    read_robot_model(file, text);
  } catch (const config::ConfigError& error) {
    std::string what = error.what();
    const std::string folder = file.parent_path().string() + "/";
    for (auto at = what.find(folder); at != std::string::npos; at = what.find(folder))
      what.erase(at, folder.size());
    return what;
  }
  return "";
}

bool stay_apart(const Scene& scene, const std::string& a, const std::string& b) {
  const auto pair = std::minmax(scene.world.find_body(a), scene.world.find_body(b));
  const auto& pairs = scene.world.no_collision;
  return std::find(pairs.begin(), pairs.end(), std::pair(pair.first, pair.second)) != pairs.end();
}

TEST(Mjcf, IsToldByItsRoot) {
  EXPECT_TRUE(is_mjcf("<?xml version='1.0'?>\n<!-- <robot> -->\n<mujoco model='m'>"));
  EXPECT_TRUE(is_mjcf("<mujoco/>"));
  EXPECT_FALSE(is_mjcf("<robot name='r'><mujoco/></robot>"));
  EXPECT_FALSE(is_mjcf("<mujocoinclude/>"));
  EXPECT_FALSE(is_mjcf("<!-- <mujoco>"));
  EXPECT_FALSE(is_mjcf(""));
  EXPECT_TRUE(is_model_file("a.MJCF"));
  EXPECT_TRUE(is_model_file("a.xml"));
}

TEST(Mjcf, FaultsNameLineAndElement) {
  struct Bad {
    std::string text, message;
  };
  const Bad kBad[] = {
      {"<mujoco><worldbody>", "m.xml:1: not valid XML: XML_ERROR_"},
      {body("\n<geom name='g' size='-1'/>"), "m.xml:2: geom 'g': size must be greater than 0"},
      {body("<geom name='g' type='capsule' size='1'/>"),
       "m.xml:1: geom 'g': size must be 2 to 3 numbers, is '1'"},
      {body("<geom name='g' type='cone' size='1'/>"), "m.xml:1: geom 'g': there is no type 'cone' of geoms"},
      {body("<geom name='g' size='1' pos='1 nan 0'/>"),
       "m.xml:1: geom 'g': pos must be 3 numbers, is '1 nan 0'"},
      {body("<geom name='g' size='1' quat='0 0 0 0'/>"), "m.xml:1: geom 'g': quat must not be zero"},
      {body("<geom name='g' size='1' material='m'/>"), "m.xml:1: geom 'g': there is no material 'm'"},
      {body("<geom name='g' type='mesh' mesh='m'/>"), "m.xml:1: geom 'g': there is no mesh 'm'"},
      {body("\n\n<joint name='j' axis='0 0 0'/>"), "m.xml:3: joint 'j': axis must not be zero"},
      {body("<joint name='j' type='hing'/>"), "m.xml:1: joint 'j': there is no type 'hing' of joints"},
      {body("<joint name='j' range='2 1'/>"), "m.xml:1: joint 'j': the lower limit is above the upper one"},
      {body("<joint name='j' limited='true'/>"), "m.xml:1: joint 'j': is limited, and has no range"},
      {body("<joint name='j' damping='-1'/>"), "m.xml:1: joint 'j': damping must be at least 0"},
      {body("<joint name='j' class='x'/>"),
       "m.xml:1: joint 'j': there is no default class 'x'; there is only 'main'"},
      {body("<joint name='j'/><joint name='j'/>"), "m.xml:1: joint 'j': there is another joint of this name"},
      {body("<body name='c'><freejoint/></body>"),
       "m.xml:1: <freejoint>: a free joint belongs to a body of the world"},
      {body("<inertial pos='0 0 0'/>"), "m.xml:1: <inertial>: <inertial> needs 'mass'"},
      {arms("<actuator><motor name='m' joint='jx'/></actuator>"),
       "m.xml:6: motor 'm': there is no joint 'jx'; did you mean 'ja'?"},
      {arms("<contact><exclude body1='a' body2='c'/></contact>"), "m.xml:6: <exclude>: there is no body 'c'"},
      {arms("<equality><weld body1='x'/></equality>"), "m.xml:6: <weld>: there is no body 'x'"},
      {arms("<keyframe><key name='home' qpos='1'/></keyframe>"),
       "m.xml:6: key 'home': qpos must be 2 numbers, is '1'"},
      {arms("<include file='none.xml'/>"), "m.xml:6: <include>: 'none.xml': no such file"},
      {"<mujoco><compiler angle='grad'/></mujoco>",
       "m.xml:1: <compiler>: angle must be radian or degree, is 'grad'"},
      {"<mujoco><default><default/></default></mujoco>",
       "m.xml:1: <default>: a <default> in another one needs 'class'"},
      {"<!DOCTYPE x><mujoco/>", "m.xml:1: document types and entities (<!...>) are not supported"},
  };
  for (const Bad& bad : kBad) EXPECT_THAT(error_of(bad.text), testing::StartsWith(bad.message)) << bad.text;
}

TEST(Mjcf, TellsAllFaultsAtOnce) {
  const test::TempFiles files;
  std::vector<config::ConfigError> errors;
  EXPECT_FALSE(load_scene(
      files.write("m.xml", body("<geom size='-1'/>\n<joint axis='0 0 0'/>\n<joint damping='-1'/>")), {},
      errors));
  ASSERT_EQ(errors.size(), 3u);
  EXPECT_EQ(errors[1].place().line, 2);
  EXPECT_EQ(errors[2].message(), "damping must be at least 0");
}

TEST(Mjcf, IsBounded) {
  std::string deep = "<mujoco><worldbody>", many = "<mujoco><worldbody>";
  for (std::size_t i = 0; i < mjcf::kMaxDepth; ++i) deep += "<body>";
  for (std::size_t i = 0; i < mjcf::kMaxDepth; ++i) deep += "</body>";
  for (std::size_t i = 0; i <= mjcf::kMaxElements; ++i) many += "<site/>";
  const std::string end = "</worldbody></mujoco>";
  EXPECT_THAT(error_of(deep + end), HasSubstr("XML elements are nested too deeply"));
  EXPECT_THAT(error_of(many + end), HasSubstr("has more than 50000 XML elements"));
  EXPECT_THAT(error_of(body("<include file='m.xml'/>")), HasSubstr("nested too deeply"));
}

TEST(Mjcf, IncludesStandInTheirPlaceAndKeepTheirLines) {
  const test::TempFiles files;
  files.write("part.xml",
              "<mujocoinclude>\n<body name='p' pos='0 0 1'><joint name='j' armature='1'/>"
              "<geom size='0.1'/></body></mujocoinclude>");
  const Scene scene =
      load_scene(files.write("m.xml", "<mujoco><worldbody><include file='part.xml'/></worldbody></mujoco>"));
  EXPECT_TRUE(scene.world.find_body("m/p").valid());
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_THAT(scene.warnings[0].file, testing::EndsWith("part.xml"));
  EXPECT_EQ(scene.warnings[0].remark.line, 2);
}

TEST(Mjcf, ClassesGiveWhatAnElementLeavesOut) {
  const RobotModel model = read(R"(<mujoco>
<default><geom size='0.1 0.5' rgba='1 0 0 1'/><joint damping='1'/>
  <default class='inner'><geom type='capsule'/><default class='inmost'><joint damping='3'/></default></default>
</default>
<worldbody><body name='a' childclass='inner'><joint name='j' class='inmost'/><geom size='0.2'/>
  <body name='b'><joint name='k'/><geom class='main'/></body></body></worldbody></mujoco>)");
  const RobotShape& capsule = model.links[0].shapes[0];
  EXPECT_EQ(capsule.kind, world::ShapeKind::kCapsule);
  EXPECT_EQ(capsule.size[0], 0.2);
  EXPECT_EQ(capsule.size[1], 1.0) << "the class's second number stays";
  EXPECT_EQ(capsule.color.value()[0], 1.0);
  EXPECT_EQ(model.links[1].shapes[0].kind, world::ShapeKind::kSphere);
  EXPECT_EQ(model.joints[0].joint.damping, 3);
  EXPECT_EQ(model.joints[1].joint.damping, 1);
}

TEST(Mjcf, SaysItselfWhatStandsFixed) {
  const std::string text =
      "<mujoco><worldbody><body name='free' pos='0 0 1'><freejoint/><geom size='0.1'/></body>"
      "<body name='post' pos='1 0 0'><geom size='0.1'/></body></worldbody></mujoco>";
  const test::TempFiles files;
  const auto fixed = [&](const std::string& key) {
    files.write("m.xml", text);
    const Scene scene =
        load_scene(files.write("s.yaml", "visum: 1\nmodels: [{name: m, file: m.xml" + key + "}]\n"));
    return scene.world.bodies[scene.world.find_body("m/free").index()].fixed;
  };
  EXPECT_FALSE(fixed(""));
  EXPECT_TRUE(fixed(", fixed: true"));
  const Scene bare = load_scene(files.write("m.xml", text));
  EXPECT_TRUE(bare.world.bodies[bare.world.find_body("m/post").index()].fixed);
}

TEST(Mjcf, KeepsApartWhatItsBitsKeepApart) {
  const test::TempFiles files;
  const auto load = [&](const std::string& more, const std::string& geom = "") {
    return load_scene(files.write("m.xml", arms(more, geom)));
  };
  EXPECT_FALSE(stay_apart(load(""), "m/a", "m/b"));
  EXPECT_TRUE(stay_apart(load("<contact><exclude body1='b' body2='a'/></contact>"), "m/a", "m/b"));
  const Scene bits = load("", "conaffinity='0'");
  EXPECT_FALSE(stay_apart(bits, "m/a", "m/worldbody"));
  EXPECT_TRUE(stay_apart(bits, "m/a", "m/b"));
  const Scene apart = load("", "contype='2' conaffinity='1'");
  EXPECT_TRUE(stay_apart(apart, "m/a", "m/b"));
  EXPECT_FALSE(stay_apart(apart, "m/a", "m/worldbody"));
  const Scene pair = load("<contact><pair geom1='gb' geom2='ga'/></contact>", "contype='0' conaffinity='0'");
  EXPECT_FALSE(stay_apart(pair, "m/a", "m/b"));
  EXPECT_TRUE(stay_apart(pair, "m/a", "m/worldbody"));
  EXPECT_FALSE(load("", "contype='0' conaffinity='0'").world.shapes[1].collides);
}

TEST(Mjcf, ActuatedJointsBecomeTheBarePart) {
  const test::TempFiles files;
  const Scene scene = load_scene(
      files.write("m.xml", arms("<actuator><motor joint='jb' gear='50' ctrlrange='-2 1'/>"
                                "<position joint='jb' forcerange='-7 7'/><general tendon='t'/></actuator>")));
  ASSERT_EQ(scene.parts.size(), 1u);
  ASSERT_EQ(scene.parts[0].context.joints.size(), 1u);
  EXPECT_EQ(scene.parts[0].context.joints[0].maximum_effort, 100);
  EXPECT_EQ(scene.world.joints[scene.parts[0].joints[0].index()].name, "m/jb");
  EXPECT_THAT(scene.losses, ElementsAre(HasSubstr("actuators of anything but joints are not read")));
}

TEST(Mjcf, StartsAtHome) {
  const test::TempFiles files;
  const Scene scene =
      load_scene(files.write("m.xml", arms("<keyframe><key name='home' qpos='0.5 -0.25'/></keyframe>")));
  EXPECT_EQ(scene.world.joints[0].initial_position, 0.5);
  EXPECT_EQ(scene.world.joints[1].initial_position, -0.25);
}

TEST(Mjcf, ConstraintsCloseLoops) {
  const test::TempFiles files;
  const Scene scene = load_scene(files.write(
      "m.xml",
      arms("<equality><connect name='c' body1='a' body2='b' anchor='0.5 0 0'/><weld name='w' body1='a'/>"
           "<joint joint1='ja' joint2='jb'/></equality>")));
  ASSERT_EQ(scene.world.joints.size(), 4u);
  const auto& connect = scene.world.joints[scene.world.find_joint("m/c").index()];
  EXPECT_EQ(connect.kind, world::JointKind::kBall);
  EXPECT_LT((connect.X_CJ.p - Eigen::Vector3d(-0.5, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(scene.world.joints[scene.world.find_joint("m/w").index()].kind, world::JointKind::kFixed);
  EXPECT_THAT(scene.losses, ElementsAre(HasSubstr("constraints of the kind <joint> are not simulated")));
}

TEST(Mjcf, SpringsActWhereTheEngineHasThem) {
  const test::TempFiles files;
  const auto file = files.write("m.xml", body("<joint name='j' stiffness='5' springref='90'/>"));
  const Scene impulse = load_scene(file, {.engine = "impulse"});
  ASSERT_EQ(impulse.world.joints.size(), 2u);
  EXPECT_EQ(impulse.world.joints[1].kind, world::JointKind::kTorsionSpring);
  EXPECT_NEAR(impulse.world.joints[1].rest, 1.5707963267948966, 1e-15);
  EXPECT_THAT(impulse.losses, IsEmpty());
  const Scene ode = load_scene(file, {.engine = "ode"});
  EXPECT_EQ(ode.world.joints.size(), 1u);
  EXPECT_THAT(ode.losses, ElementsAre(HasSubstr("engine 'ode' has no springs")));
}

TEST(Mjcf, LooksThatNobodyTouchesMayBeMissing) {
  const std::string head =
      "<mujoco><asset><mesh name='m' file='none.stl'/></asset><worldbody><body name='b'>"
      "<joint name='j'/><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>";
  const std::string end = "</body></worldbody></mujoco>";
  EXPECT_THAT(read(head + "<geom type='mesh' mesh='m' contype='0' conaffinity='0'/>" + end).losses[0].text,
              HasSubstr("a mesh is not shown (mesh 'none.stl': no such file"));
  EXPECT_THAT(error_of(head + "<geom type='mesh' mesh='m'/>" + end), HasSubstr("mesh 'm': mesh 'none.stl'"));
}

TEST(Mjcf, TellsWhatIsLost) {
  const test::TempFiles files;
  const Scene scene = load_scene(files.write("m.xml", R"(<mujoco><option wind='1 0 0'/><worldbody><light/>
<geom type='hfield' hfield='h'/>
<body name='b' gravcomp='1'><joint name='j' type='ball' range='0 1' damping='1'/><geom size='0.1' friction='1'/></body>
<body name='c' mocap='true'><geom type='ellipsoid' size='1 2 3'/></body>
</worldbody><sensor><gyro site='s'/></sensor><tendon><fixed name='t'/></tendon></mujoco>)"));
  std::vector<std::string> told;
  for (const FileRemark& warning : scene.warnings)
    told.push_back(std::to_string(warning.remark.line) + " " + warning.remark.text.substr(11));
  EXPECT_THAT(
      told,
      testing::UnorderedElementsAre(
          "1 <light> is not read: <light>", "2 geoms of type hfield are not simulated: <geom>",
          "3 compensation of gravity is not simulated: body 'b'",
          "3 friction of geoms is not read, surfaces are the scene's: <geom>",
          "4 mocap bodies stand still: body 'c'", "3 damping of a ball joint is not simulated: joint 'j'",
          "3 the range of a ball joint is not simulated: joint 'j'",
          "1 wind of the medium is not simulated: <option>", "5 what stands in <sensor> is not read: <gyro>",
          "5 what stands in <tendon> is not read: fixed 't'"));
  ASSERT_EQ(scene.repairs.size(), 1u);
  EXPECT_EQ(scene.repairs[0].remark.text, "model 'm': ellipsoids are made of triangles: <geom>");
}

TEST(Mjcf, IsConverted) {
  const test::TempFiles files;
  const auto file = files.write("m.xml", arms(""));
  convert(file, file.parent_path() / "m.yaml", {});
  EXPECT_EQ(load_scene(file.parent_path() / "m.yaml").world.joints.size(), 2u);
}

}  // namespace
}  // namespace visum::scene

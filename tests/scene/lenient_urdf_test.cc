// URDFs with faults in what is not used, or can be repaired: they load, and say what was done, and where.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "server/scene/all_errors.h"
#include "server/scene/model_errors.h"
#include "server/scene/robot_model.h"
#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kMassless = "<link name='base'/>";

std::string inertial(const std::string& mass, const std::string& inertia) {
  return "<inertial><mass value='" + mass + "'/><inertia " + inertia + "/></inertial>";
}
const std::string kBall = "ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'";

// A base, and an arm that turns on it.
std::string arm(const std::string& in_arm, const std::string& more = "") {
  return "<robot name='r'>" + kMassless + "\n<link name='arm'>" + in_arm +
         "</link>\n<joint name='turn' type='continuous'><parent link='base'/><child link='arm'/>"
         "<axis xyz='0 0 1'/></joint>\n" +
         more + "</robot>";
}

class LenientUrdf : public testing::Test {
 protected:
  Scene load(const std::string& urdf, const std::string& keys = "") {
    files_.write("m.urdf", urdf);
    return load_scene(files_.write("s.yaml", "visum: 1\nmodels: [{name: m, file: m.urdf" + keys + "}]"));
  }
  static const world::Body& arm_of(const Scene& scene) { return scene.world.bodies.back(); }

  test::TempFiles files_;
};

TEST_F(LenientUrdf, AFixedJointsAxisAndLimitMeanNothing) {
  const Scene scene = load(arm(inertial("1", kBall),
                               "<link name='tip'/><joint name='f' type='fixed'><parent link='arm'/><child "
                               "link='tip'/><axis xyz='0 0 0'/><limit effort='-1' velocity='x'/></joint>"));
  EXPECT_EQ(scene.world.joints.size(), 1u);
  EXPECT_THAT(scene.losses, ElementsAre());
}

TEST_F(LenientUrdf, AMovingLinkWithoutMassIsFilledWithWater) {
  const std::string box = "<collision><geometry><box size='0.1 0.2 0.5'/></geometry></collision>";
  const Scene scene = load(arm(box));
  EXPECT_NEAR(arm_of(scene).mass_kg, 10.0, 1e-9);
  EXPECT_NEAR(arm_of(scene).inertia_C(2, 2), 10.0 * (0.01 + 0.04) / 12, 1e-9);
  ASSERT_EQ(scene.repairs.size(), 1u);
  EXPECT_EQ(scene.repairs[0].remark.line, 2);
  EXPECT_EQ(scene.repairs[0].remark.text,
            "model 'm': link 'arm' moves without mass: its shapes of 1000 kg/m³ give it 10 kg");
  EXPECT_NEAR(arm_of(load(arm(box), ", density: 100")).mass_kg, 1.0, 1e-9);
  EXPECT_THAT(test::TempFiles().error_of([&] { load(arm(box), ", repair: false"); }),
              HasSubstr("m.urdf:2: link 'arm': moves but has no mass: give it an <inertial>"));
}

TEST_F(LenientUrdf, AMovingLinkWithoutMassAndShapesIsASmallBall) {
  const Scene scene = load(arm(""));
  EXPECT_NEAR(arm_of(scene).mass_kg, 0.1, 1e-12);
  EXPECT_NEAR(arm_of(scene).inertia_C(0, 0), 0.4 * 0.1 * 0.05 * 0.05, 1e-12);
}

TEST_F(LenientUrdf, AnInertiaOfZeroComesFromTheShapes) {
  const Scene scene = load(arm(inertial("3", "ixx='0' iyy='0' izz='0' ixy='0' ixz='0' iyz='0'") +
                               "<collision><geometry><sphere radius='0.1'/></geometry></collision>"));
  EXPECT_EQ(arm_of(scene).mass_kg, 3.0);
  EXPECT_NEAR(arm_of(scene).inertia_C(1, 1), 0.4 * 3 * 0.01, 1e-12);
  EXPECT_EQ(scene.repairs.size(), 2u) << "one from the file, one from the world";
}

TEST_F(LenientUrdf, AnInertiaThatNoSolidHasIsRaisedAsLittleAsCanBe) {
  const Scene scene = load(arm(inertial("1", "ixx='1' iyy='1' izz='4' ixy='0' ixz='0' iyz='0'")));
  EXPECT_NEAR(arm_of(scene).inertia_C(0, 0), 2.0, 1e-6);
  EXPECT_NEAR(arm_of(scene).inertia_C(2, 2), 4.0, 1e-12);
  EXPECT_EQ(scene.repairs.size(), 1u);
  EXPECT_THAT(test::TempFiles().error_of([&] {
    load(arm(inertial("1", "ixx='1' iyy='1' izz='4' ixy='0' ixz='0' iyz='0'")), ", repair: false");
  }),
              HasSubstr("m.urdf:2: link 'arm' has moments of inertia that no solid has"));
}

TEST_F(LenientUrdf, ATinyMassKeepsItsFigures) {
  const Scene scene = load(arm(inertial("2e-7", "ixx='1e-9' iyy='1e-9' izz='1e-9' ixy='0' ixz='0' iyz='0'")));
  ASSERT_EQ(scene.world.bodies.size(), 2u) << "a link of less than 1e-6 kg is one, too";
  EXPECT_NEAR(arm_of(scene).mass_kg, 2e-7, 1e-16);
  EXPECT_NEAR(arm_of(scene).inertia_C(0, 0), 1e-9, 1e-18);
}

const std::string kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";

std::string mesh_of(const std::string& tag, const std::string& file) {
  return "<" + tag + "><geometry><mesh filename='" + file + "'/></geometry></" + tag + ">";
}

TEST_F(LenientUrdf, MeshesOfMovingLinksCollideAsHulls) {
  files_.write("t.obj", kTetrahedron);
  std::string urdf = arm(inertial("1", kBall) + mesh_of("visual", "t.obj") + mesh_of("collision", "t.obj"));
  urdf.replace(urdf.find(kMassless), kMassless.size(),
               "<link name='base'>" + mesh_of("collision", "t.obj") + "</link>");
  const Scene scene = load(urdf);
  ASSERT_EQ(scene.world.shapes.size(), 3u);
  EXPECT_EQ(scene.world.shapes[0].kind, world::ShapeKind::kMesh) << "the base stands still";
  EXPECT_EQ(scene.world.shapes[1].kind, world::ShapeKind::kConvex);
  EXPECT_TRUE(scene.world.shapes[1].collides);
  EXPECT_EQ(scene.world.shapes[1].color[3], 0.0);
  EXPECT_EQ(scene.world.shapes[2].kind, world::ShapeKind::kMesh) << "it looks as before";
  EXPECT_FALSE(scene.world.shapes[2].collides);
  EXPECT_GT(scene.world.shapes[2].color[3], 0.0);
  ASSERT_EQ(scene.repairs.size(), 1u);
  EXPECT_EQ(scene.repairs[0].remark.text,
            "model 'm': meshes of moving links collide as their convex hulls: 1 ('collision_meshes: "
            "triangles' keeps them)");
}

TEST_F(LenientUrdf, TrianglesCollideWhereTheSceneWantsThem) {
  files_.write("t.obj", kTetrahedron);
  files_.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n");
  const auto kind = [&](const std::string& file, const std::string& keys) {
    return load(arm(inertial("1", kBall) + mesh_of("collision", file)), keys).world.shapes.front().kind;
  };
  EXPECT_EQ(kind("t.obj", ""), world::ShapeKind::kConvex);
  EXPECT_EQ(kind("t.obj", ", collision_meshes: triangles"), world::ShapeKind::kMesh);
  EXPECT_EQ(kind("flat.obj", ", collision_meshes: hulls"), world::ShapeKind::kMesh) << "no volume";
  EXPECT_THAT(files_.error_of([&] { kind("t.obj", ", collision_meshes: hull"); }),
              HasSubstr("did you mean 'hulls'?"));
}

TEST_F(LenientUrdf, ALinkOnAFloatingJointIsFree) {
  const std::string arm_joint =
      "<link name='tip'/><joint name='f' type='fixed'><parent link='arm'/><child link='tip'/></joint>";
  std::string urdf = arm(inertial("1", kBall), arm_joint);
  urdf.replace(urdf.find("continuous"), 10, "floating");
  const Scene scene = load(urdf);
  EXPECT_TRUE(scene.world.joints.empty());
  EXPECT_TRUE(scene.world.bodies[0].fixed) << "the base";
  EXPECT_FALSE(arm_of(scene).fixed);
  EXPECT_TRUE(arm_of(load(urdf, ", fixed: true")).fixed) << "the scene's own word";
}

TEST_F(LenientUrdf, LimitsTheWrongWayRoundAreNone) {
  std::string urdf = arm(inertial("1", kBall));
  urdf.replace(urdf.find("continuous"), 10, "revolute");
  urdf.replace(urdf.find("</joint>"), 0, "<limit lower='1' upper='-1' effort='1' velocity='1'/>");
  const Scene scene = load(urdf);
  EXPECT_FALSE(scene.world.joints.front().limited);
  EXPECT_THAT(scene.losses, ElementsAre("model 'm': joint 'turn' moves without limits: its lower limit is "
                                        "above the upper one"));
}

TEST_F(LenientUrdf, SpringsOfJointsAct) {
  std::string urdf = arm(inertial("1", kBall));
  urdf.replace(urdf.find("</joint>"), 0, "<dynamics spring_stiffness='30' spring_reference='0.1'/>");
  files_.write("m.urdf", urdf);
  const Scene scene =
      load_scene(files_.write("s.yaml", "visum: 1\nengine: impulse\nmodels: [{name: m, file: m.urdf}]"));
  ASSERT_EQ(scene.world.joints.size(), 2u);
  EXPECT_EQ(scene.world.joints[1].kind, world::JointKind::kTorsionSpring);
  EXPECT_EQ(scene.world.joints[1].stiffness, 30.0);
  EXPECT_EQ(scene.world.joints[1].rest, 0.1);
}

TEST_F(LenientUrdf, ShapesWithoutSizeAreLeftOut) {
  const Scene scene =
      load(arm(inertial("1", kBall) + "<visual><geometry><box size='1 0 1'/></geometry></visual>\n"
                                      "<collision><geometry><sphere radius='0'/></geometry></collision>"));
  EXPECT_TRUE(scene.world.shapes.empty());
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0].remark.text,
            "model 'm': a <visual> of link 'arm' is left out: its box has the size '1 0 1'");
  ASSERT_EQ(scene.repairs.size(), 1u);
  EXPECT_EQ(scene.repairs[0].remark.line, 3);
}

TEST_F(LenientUrdf, ALinkAndAJointMayHaveOneName) {
  std::string urdf = arm(inertial("1", kBall));
  urdf.replace(urdf.find("'turn'"), 6, "'arm'");
  const Scene scene = load(urdf);
  EXPECT_EQ(scene.world.joints.front().name, "m/arm");
}

TEST_F(LenientUrdf, EffortLimitsAreNotUsed) {
  std::string urdf = arm(inertial("1", kBall));
  urdf.replace(urdf.find("</joint>"), 0, "<limit effort='-5' velocity='1'/>");
  const Scene scene = load(urdf);
  EXPECT_THAT(scene.losses,
              ElementsAre("model 'm': joint 'turn' has the effort limit '-5', which is not used"));
}

TEST_F(LenientUrdf, PackagesAreFoundByNameManifestAndEnvironment) {
  const std::string stl =
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop\nendfacet\nendsolid s\n";
  for (const char* folder : {"given", "env/p", "checkout"})
    std::filesystem::create_directories(files_.folder() / folder / "urdf");
  const auto found = [&](const Packages& packages, const char* model) {
    return find_in_package("p/a.stl", files_.folder() / model, packages).lexically_relative(files_.folder());
  };
  EXPECT_EQ(found({}, "checkout/urdf/m.urdf"), "");
  files_.write("given/a.stl", stl);
  EXPECT_EQ(found({{{"p", files_.folder() / "given"}}, {}}, "m.urdf"), "given/a.stl");
  files_.write("env/p/a.stl", stl);
  ::setenv("ROS_PACKAGE_PATH", ("/nowhere:" + (files_.folder() / "env").string()).c_str(), 1);
  EXPECT_EQ(found(with_environment({}), "m.urdf"), "env/p/a.stl");
  ::unsetenv("ROS_PACKAGE_PATH");
  files_.write("checkout/package.xml", "<package><name>p</name></package>");
  files_.write("checkout/a.stl", stl);
  EXPECT_EQ(found({}, "checkout/urdf/m.urdf"), "checkout/a.stl");
}

TEST_F(LenientUrdf, AllErrorsAreToldAtOnceWithTheFilesOwnAddresses) {
  const std::string gone =
      "<collision><geometry><mesh filename='package://p/gone.stl'/></geometry></collision>\n";
  const std::string wrong = "<collision><geometry><box size='1 1'/></geometry></collision>\n";
  const auto errors_of = [&](const std::string& urdf) {
    files_.write("m.urdf", urdf);
    std::vector<config::ConfigError> errors;
    load_scene(files_.write("s.yaml", "visum: 1\nmodels: [{name: m, file: m.urdf}]"), {}, errors);
    std::vector<std::string> messages;
    for (const auto& error : errors)
      messages.push_back(std::to_string(error.place().line) + ": " + error.message());
    return messages;
  };
  EXPECT_THAT(errors_of(arm(wrong + "<collision><geometry><sphere/></geometry></collision>")),
              ElementsAre("2: box size must be 3 numbers, is '1 1'", "3: <sphere> needs 'radius'"));
  EXPECT_THAT(
      errors_of(arm(gone + "<collision><geometry><mesh filename='gone.obj'/></geometry></collision>")),
      ElementsAre(HasSubstr("mesh 'package://p/gone.stl': no such file"),
                  HasSubstr("mesh 'gone.obj': no such file")));
}

}  // namespace
}  // namespace visum::scene

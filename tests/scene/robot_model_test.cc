#include "server/scene/robot_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "protocol/config/read_file.h"
#include "server/scene/mesh_path.h"
#include "server/scene/scene.h"
#include "tests/scene/data_folder.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kOneKilogram =
    "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";

RobotModel read(const std::string& name) {
  return read_robot_model(kData / name, config::read_file(kData / name, 1u << 20).bytes);
}

RobotModel joined(const std::string& name) {
  RobotModel model = read(name);
  join_links(model);
  return model;
}

std::vector<std::string> link_names(const RobotModel& model) {
  std::vector<std::string> names;
  for (const RobotLink& link : model.links) names.push_back(link.name);
  return names;
}

std::vector<std::string> joint_names(const RobotModel& model) {
  std::vector<std::string> names;
  for (const RobotJoint& joint : model.joints) names.push_back(joint.joint.name);
  return names;
}

TEST(Urdf, NothingIsDroppedOnTheWayAndTheOrderIsTheFiles) {
  const RobotModel model = read("robot.urdf");
  EXPECT_THAT(link_names(model), ElementsAre("base", "zz_upper_arm", "lower_arm", "tool", "tcp", "finger"));
  EXPECT_THAT(joint_names(model), ElementsAre("shoulder", "elbow", "flange", "tip", "grip"));
  EXPECT_EQ(model.links[0].mass.mass_kg, 0.0) << "a massless link stays one";
}

TEST(Urdf, JointsKeepTheirFiguresToTheLastDigits) {
  const RobotModel model = read("robot.urdf");
  const world::Joint& shoulder = model.joints[0].joint;
  EXPECT_EQ(shoulder.kind, world::JointKind::kHinge);
  EXPECT_EQ(shoulder.axis_J, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(shoulder.lower, -1.5);
  EXPECT_EQ(shoulder.damping, 0.3);
  EXPECT_EQ(shoulder.friction, 0.7);
  EXPECT_EQ(shoulder.X_PJ.p, Eigen::Vector3d(0, 0, 0.1));
  const world::Joint& elbow = model.joints[1].joint;
  EXPECT_FALSE(elbow.limited);
  EXPECT_NEAR(elbow.X_PJ.q.x(), std::sqrt(0.5), 1e-15);
  EXPECT_EQ(model.joints[4].joint.kind, world::JointKind::kSlider);
}

TEST(Urdf, InertiaIsTurnedIntoTheLinksAxes) {
  const RobotLink link = read("robot.urdf").links[1];
  EXPECT_EQ(link.mass.mass_kg, 2);
  EXPECT_EQ(link.mass.com, Eigen::Vector3d(0, 0, 0.2));
  EXPECT_NEAR(link.mass.inertia_C(0, 0), 0.02, 1e-15) << "its frame is turned by a quarter about z";
  EXPECT_NEAR(link.mass.inertia_C(1, 1), 0.03, 1e-15);
}

TEST(Urdf, FixedJointsJoinLinksWithTheirMasses) {
  const RobotModel model = joined("robot.urdf");
  EXPECT_THAT(link_names(model), ElementsAre("base", "zz_upper_arm", "lower_arm", "finger"));
  EXPECT_THAT(joint_names(model), ElementsAre("shoulder", "elbow", "grip"));
  const RobotLink& lower = model.links[2];
  EXPECT_NEAR(lower.mass.mass_kg, 2, 1e-15);
  EXPECT_TRUE(lower.mass.com.isApprox(Eigen::Vector3d(0, 0.1, 0)));
  EXPECT_NEAR(lower.mass.inertia_C(1, 1), 0.02, 1e-15);
  EXPECT_NEAR(lower.mass.inertia_C(0, 0), 0.02 + 2 * 0.01, 1e-15) << "two masses, each 0.1 m away";
  EXPECT_EQ(lower.shapes[1].name, "pad");
  EXPECT_EQ(lower.shapes[1].link, "tool");
  EXPECT_TRUE(lower.shapes[1].X_LS.p.isApprox(Eigen::Vector3d(0, 0.2, 0)));
  const world::Joint& grip = model.joints[2].joint;
  EXPECT_EQ(model.joints[2].parent, "lower_arm");
  EXPECT_TRUE(grip.X_PJ.p.isApprox(Eigen::Vector3d(0, 0.25, 0)));
  EXPECT_TRUE((grip.X_PJ.q * grip.axis_J).isApprox(Eigen::Vector3d(-1, 0, 0)));
}

TEST(Urdf, LossesSayWhatIsNotSimulated) {
  const RobotModel model = joined("robot.urdf");
  EXPECT_THAT(model.losses,
              ElementsAre("1 <transmission> element is not read",
                          "visual 'logo' of link 'zz_upper_arm' is not shown: it is the mesh "
                          "'package://data/meshes/logo.ply', and only .stl, .obj and .dae are read"));
  EXPECT_THAT(model.notes,
              ElementsAre("fixed joints join 'tool', 'tcp' into link 'lower_arm': one body of that name"));
}

TEST(Urdf, VisualsGiveTheirColourToEqualSolids) {
  const RobotLink link = read("robot.urdf").links[1];
  ASSERT_EQ(link.shapes.size(), 3u);
  EXPECT_EQ(link.shapes[0].name, "tube_c");
  EXPECT_TRUE(link.shapes[0].collides);
  EXPECT_THAT(*link.shapes[0].color,
              ElementsAre(DoubleNear(0.9, 1e-6), DoubleNear(0.1, 1e-6), DoubleNear(0.2, 1e-6), 1));
  EXPECT_EQ(link.shapes[1].name, "box_c");
  EXPECT_EQ((*link.shapes[1].color)[3], 0.0) << "a solid without looks is not drawn where others are";
  EXPECT_EQ(link.shapes[2].name, "cap");
  EXPECT_FALSE(link.shapes[2].collides);
}

TEST(Urdf, MeshesAreFoundInPackagesAboveTheModel) {
  const RobotLink link = read("robot.urdf").links[2];
  EXPECT_EQ(link.shapes[0].mesh, kData / "meshes/wedge.stl");
  EXPECT_EQ(link.shapes[0].scale, Eigen::Vector3d(0.1, 0.1, 0.1));
  EXPECT_EQ(link.shapes[0].name, "collision");
  const config::Place place{"m.urdf", 1, ""};
  EXPECT_EQ(resolve_mesh("meshes/wedge.stl", kData / "robot.urdf", {}, place), kData / "meshes/wedge.stl");
  EXPECT_EQ(resolve_mesh("file://meshes/wedge.stl", kData / "robot.urdf", {}, place),
            kData / "meshes/wedge.stl");
  EXPECT_EQ(resolve_mesh("model://scene/data/wedge.obj", kData / "robot.urdf", {}, place),
            kData / "wedge.obj");
  EXPECT_EQ(resolve_mesh("package:///scene/data/wedge.obj", kData / "robot.urdf", {}, place),
            kData / "wedge.obj");
  const Packages given{{{"shelf", kData / "meshes"}}, {}};
  EXPECT_EQ(resolve_mesh("package:///shelf/wedge.stl", kData / "robot.urdf", given, place),
            kData / "meshes/wedge.stl");
}

TEST(Urdf, SolidsWithTheSameNameAreKept) {
  const RobotModel model = read_robot_model(
      "m.urdf",
      "<robot name='r'><link name='a'>" + kOneKilogram +
          "<collision name='x'><geometry><box size='1 1 1'/></geometry></collision>"
          "<collision name='x'><geometry><box size='1 1 2'/></geometry></collision></link></robot>");
  ASSERT_EQ(model.links[0].shapes.size(), 2u);
  EXPECT_EQ(model.links[0].shapes[1].name, "x");
}

TEST(Urdf, ARootCalledWorldIsTheWorld) {
  RobotModel model =
      read_robot_model("m.urdf", "<robot name='r'><link name='world'/><link name='a'>" + kOneKilogram +
                                     "</link><link name='b'>" + kOneKilogram +
                                     "</link><joint name='f' type='fixed'><parent link='world'/><child "
                                     "link='a'/><origin xyz='0 0 1'/></joint>"
                                     "<joint name='j' type='continuous'><parent link='a'/><child "
                                     "link='b'/><axis xyz='0 0 1'/></joint></robot>");
  join_links(model);
  EXPECT_THAT(link_names(model), ElementsAre("a", "b"));
  EXPECT_TRUE(model.links[0].on_ground);
  EXPECT_FALSE(model.links[1].on_ground);
  EXPECT_EQ(model.links[0].X_ML.p, Eigen::Vector3d(0, 0, 1));
}

// Against the definition R = Rz Ry Rx.
TEST(Urdf, AnglesAreReadAsTheStandardSays) {
  for (const double pitch : {0.3, 1.5707963267948966, -1.5707963267948966}) {
    const RobotModel model = read_robot_model(
        "m.urdf",
        "<robot name='r'><link name='a'>" + kOneKilogram + "</link><link name='b'>" + kOneKilogram +
            "</link><joint name='j' type='continuous'><parent link='a'/><child link='b'/><origin rpy='0.4 " +
            std::to_string(pitch) + " 0.7'/><axis xyz='0 0 1'/></joint></robot>");
    const double p = std::stod(std::to_string(pitch));
    const Eigen::Quaterniond expected = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ()) *
                                        Eigen::AngleAxisd(p, Eigen::Vector3d::UnitY()) *
                                        Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX());
    EXPECT_LT(model.joints[0].joint.X_PJ.q.angularDistance(expected), 5e-9) << pitch;
  }
}

TEST(Urdf, WhatIsNotReadMayHoldColoursOfAnotherKind) {
  const RobotModel model = read_robot_model(
      "m.urdf", "<robot name='r'><link name='a'>" + kOneKilogram +
                    "<sensor><color/></sensor><gazebo><material><color>1 0 0</color></material></gazebo>"
                    "</link></robot>");
  EXPECT_THAT(link_names(model), ElementsAre("a"));
  EXPECT_THAT(model.losses, ElementsAre("1 <gazebo> element is not read", "1 <sensor> element is not read"));
}

const std::string kOneKilogramInSdf =
    "<inertial><mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>";

TEST(Sdf, AJointOfANestedModelToTheWorldStandsWhereThatModelDoes) {
  const RobotModel model = read_robot_model(
      "m.sdf",
      "<sdf version='1.8'><model name='cell'><link name='base'/><model name='door'><pose>2 0 0 0 0 0</pose>"
      "<link name='leaf'><pose>0.5 0 0 0 0 0</pose>" +
          kOneKilogramInSdf +
          "</link><joint name='hinge' type='revolute'><pose relative_to='__model__'>0 0 1 0 0 0</pose>"
          "<parent>world</parent><child>leaf</child><axis><xyz>0 0 1</xyz></axis></joint></model></model>"
          "</sdf>");
  EXPECT_TRUE(model.joints[0].joint.X_PJ.p.isApprox(Eigen::Vector3d(2, 0, 1)));
  EXPECT_TRUE(model.joints[0].joint.X_CJ.p.isApprox(Eigen::Vector3d(-0.5, 0, 1)));
}

TEST(Sdf, WhatIsNestedInAStaticModelStandsStill) {
  const RobotModel model =
      read_robot_model("m.sdf",
                       "<sdf version='1.8'><model name='cell'><static>true</static><link name='base'/>"
                       "<model name='door'><link name='leaf'/></model></model></sdf>");
  ASSERT_EQ(model.links.size(), 2u);
  EXPECT_TRUE(model.links[0].on_ground);
  EXPECT_TRUE(model.links[1].on_ground);
}

TEST(Sdf, LossesSayWhatWouldChangeThePhysics) {
  const RobotModel model =
      read_robot_model("m.sdf",
                       "<sdf version='1.8'><model name='cell'><pose>0 0 5 0 0 0</pose><link name='balloon'>"
                       "<gravity>false</gravity><kinematic>true</kinematic>"
                       "<inertial><mass>0.05</mass></inertial></link></model></sdf>");
  EXPECT_THAT(
      model.losses,
      ElementsAre("the model's own <pose> is not read: the scene's 'pose' places it",
                  "link 'balloon' gives no <inertia>: SDF's 1 kg·m² is used if it moves",
                  "link 'balloon' feels gravity like all others: a link without gravity is not simulated",
                  "link 'balloon' is moved by forces like all others: <kinematic> is not simulated"));
  EXPECT_EQ(model.links[0].X_ML.p, Eigen::Vector3d::Zero());
}

RobotLink sdf_link(const std::string& inside) {
  return read_robot_model(
             "m.sdf", "<sdf version='1.9'><model name='m'><link name='a'>" + inside + "</link></model></sdf>")
      .links.at(0);
}

TEST(Sdf, APlaneThatIsOnlySeenEndsWhereItsSizeSays) {
  const RobotLink link = sdf_link(
      "<visual name='sticker'><pose>1 0 0 0 0 0</pose><geometry><plane><normal>0 1 0</normal>"
      "<size>0.1 0.2</size></plane></geometry></visual>");
  ASSERT_EQ(link.shapes.size(), 1u);
  const RobotShape& sheet = link.shapes[0];
  EXPECT_EQ(sheet.kind, world::ShapeKind::kBox);
  EXPECT_EQ(sheet.size[0], 0.1);
  EXPECT_EQ(sheet.size[1], 0.2);
  const Eigen::Vector3d face = sheet.X_LS * Eigen::Vector3d(0, 0, sheet.size[2] / 2);
  EXPECT_TRUE(face.isApprox(Eigen::Vector3d(1, 0, 0))) << "its face is where the plane is";
}

TEST(Sdf, APlaneThatIsSeenWhereOneCollidesGivesItsColour) {
  const std::string plane = "<geometry><plane><size>5 5</size></plane></geometry>";
  const RobotLink link = sdf_link("<collision name='c'>" + plane + "</collision><visual name='v'>" + plane +
                                  "<material><diffuse>0 1 0 1</diffuse></material></visual>");
  ASSERT_EQ(link.shapes.size(), 1u);
  EXPECT_EQ(link.shapes[0].kind, world::ShapeKind::kPlane);
  EXPECT_EQ(link.shapes[0].size, (std::array<double, 3>{}));
  EXPECT_THAT(*link.shapes[0].color, ElementsAre(0, 1, 0, 1));
}

TEST(Sdf, TransparencyTakesFromTheColour) {
  const std::string box = "<geometry><box><size>1 1 1</size></box></geometry>";
  const RobotLink link = sdf_link("<visual name='ghost'><transparency>1</transparency>" + box +
                                  "</visual><visual name='pane'><pose>2 0 0 0 0 0</pose><transparency>0.5"
                                  "</transparency><material><diffuse>1 0 0 0.5</diffuse></material>" +
                                  box + "</visual>");
  ASSERT_EQ(link.shapes.size(), 2u);
  EXPECT_EQ((*link.shapes[0].color)[3], 0.0) << "sensors do not see what has no alpha";
  EXPECT_THAT(*link.shapes[1].color, ElementsAre(1, 0, 0, 0.25));
}

TEST(Sdf, NestedModelsFramesAndLimitsAreRead) {
  const RobotModel model = joined("nested.sdf");
  EXPECT_THAT(link_names(model), ElementsAre("base", "arm", "tool::tip"));
  EXPECT_TRUE(model.links[1].X_ML.p.isApprox(Eigen::Vector3d(0, 0, 2)));
  EXPECT_TRUE(model.links[2].X_ML.p.isApprox(Eigen::Vector3d(1, 2, 0)));
  EXPECT_EQ(model.links[0].shapes[0].kind, world::ShapeKind::kCapsule);
  const world::Joint& swing = model.joints[0].joint;
  EXPECT_TRUE(swing.limited);
  EXPECT_EQ(swing.lower, -1e6) << "no lower limit";
  EXPECT_EQ(swing.upper, 1.0);
  EXPECT_EQ(swing.damping, 0.5);
  EXPECT_EQ(swing.friction, 0.25);
  EXPECT_GT(model.joints[0].stiffness, 0.0);
  EXPECT_THAT(model.losses,
              ElementsAre("1 <sensor> element is not read",
                          "link 'arm' gives no <inertial>: SDF's 1 kg and 1 kg·m² are used if it moves",
                          "link 'tool::tip' gives no <inertia>: SDF's 1 kg·m² is used if it moves"));
}

TEST(RobotModel, ReadingPrintsNothing) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  read("robot.urdf");
  EXPECT_THROW(read_robot_model("m.sdf", "<sdf version='1.7'><model name='a'/></sdf>"), config::ConfigError);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace visum::scene

// Poses of SDF by the format's rules, with figures found by hand.
#include <gmock/gmock.h>

#include <numbers>

#include "protocol/config/config.h"
#include "server/scene/robot_model.h"

namespace visum::scene {
namespace {

using ::testing::HasSubstr;

constexpr double kQuarter = std::numbers::pi / 2;

RobotModel model(const std::string& content, const std::string& version = "1.9") {
  return read_robot_model("m.sdf",
                          "<sdf version='" + version + "'><model name='m'>" + content + "</model></sdf>");
}

std::string error_of(const std::string& content) {
  try {
    model(content);
  } catch (const config::ConfigError& error) {
    return error.what();
  }
  return "no error";
}

world::Pose pose(double x, double y, double z, double yaw = 0.0) {
  return {{x, y, z}, Eigen::Quaterniond(Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()))};
}

void expect_pose(const world::Pose& is, const world::Pose& should) {
  EXPECT_LT((is.p - should.p).norm(), 1e-12) << is.p.transpose();
  EXPECT_LT(is.q.angularDistance(should.q), 1e-7);
}

const RobotLink& link(const RobotModel& model, const std::string& name) {
  for (const auto& link : model.links)
    if (link.name == name) return link;
  throw std::runtime_error("no link " + name);
}

constexpr const char* kTwo =
    "<link name='a'><pose>1 0 0 0 0 1.5707963267948966</pose></link>"
    "<link name='b'><pose relative_to='a'>2 0 0 0 0 0</pose></link>";

TEST(SdfFrames, APoseIsRelativeToTheFrameThatItNames) {
  const RobotModel robot = model(kTwo);
  expect_pose(link(robot, "a").X_ML, pose(1, 0, 0, kQuarter));
  expect_pose(link(robot, "b").X_ML, pose(1, 2, 0, kQuarter));
}

TEST(SdfFrames, AFrameMayStandOnAnother) {
  const RobotModel robot =
      model(std::string(kTwo) +
            "<frame name='f' attached_to='b'><pose>0 0 3 0 0 0</pose></frame>"
            "<frame name='g' attached_to='a'><pose relative_to='f'>0 0 1 0 0 0</pose></frame>"
            "<link name='c'><pose relative_to='g'>0 1 0 0 0 0</pose></link>");
  expect_pose(link(robot, "c").X_ML, pose(0, 2, 4, kQuarter));
}

// The joint stands at its child unless it says otherwise; its axis is in its own frame unless it says
// otherwise.
TEST(SdfFrames, AJointStandsAtItsChild) {
  const RobotModel robot =
      model(std::string(kTwo) +
            "<joint name='j' type='revolute'><parent>a</parent><child>b</child><pose>0 0 0.5 0 0 0"
            "</pose><axis><xyz expressed_in='__model__'>1 0 0</xyz></axis></joint>");
  const auto& joint = robot.joints.at(0).joint;
  expect_pose(joint.X_PJ, pose(2, 0, 0.5));
  expect_pose(joint.X_CJ, pose(0, 0, 0.5));
  EXPECT_LT((joint.axis_J - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12) << joint.axis_J.transpose();
}

TEST(SdfFrames, AJointMayBeRelativeToAnythingAndHangOnFrames) {
  const RobotModel robot = model(std::string(kTwo) +
                                 "<frame name='f' attached_to='a'/><frame name='g' attached_to='f'/>"
                                 "<joint name='j' type='fixed'><parent>g</parent><child>b</child>"
                                 "<pose relative_to='__model__'>0 0 0 0 0 0</pose></joint>");
  EXPECT_EQ(robot.joints.at(0).parent, "a");
  expect_pose(robot.joints.at(0).joint.X_PJ, pose(0, 1, 0, -kQuarter));
}

// Before 1.5, and with use_parent_model_frame until 1.6, axes were in the model's frame.
TEST(SdfFrames, OldAxesAreInTheModelsFrame) {
  const std::string joint =
      "<joint name='j' type='revolute'><parent>a</parent><child>b</child><axis><xyz>1 0 "
      "0</xyz>%</axis></joint>";
  const std::string old_two =
      "<link name='a'/><link name='b'><pose>1 0 0 0 0 1.5707963267948966</pose></link>";
  const auto axis = [&](const std::string& flag, const std::string& version) {
    std::string text = joint;
    text.replace(text.find('%'), 1, flag);
    return model(old_two + text, version).joints.at(0).joint.axis_J;
  };
  const Eigen::Vector3d own(1, 0, 0), turned(0, -1, 0);
  EXPECT_LT((axis("", "1.4") - turned).norm(), 1e-12);
  EXPECT_LT((axis("", "1.6") - own).norm(), 1e-12);
  EXPECT_LT((axis("<use_parent_model_frame>true</use_parent_model_frame>", "1.6") - turned).norm(), 1e-12);
  EXPECT_LT((axis("", "1.9") - own).norm(), 1e-12);
}

TEST(SdfFrames, NestedModelsHaveFramesOfTheirOwn) {
  const RobotModel robot = model(
      "<link name='base'/><model name='inner' placement_frame='grip'><pose>0 0 2 0 0 0</pose>"
      "<link name='l'><pose>1 0 0 0 0 0</pose></link><frame name='grip' attached_to='l'><pose>0 1 0 0 0 "
      "0</pose></frame>"
      "</model><link name='tip'><pose relative_to='inner::grip'>0 0 1 0 0 0</pose></link>"
      "<joint name='j' type='fixed'><parent>base</parent><child>inner</child></joint>");
  expect_pose(link(robot, "inner::l").X_ML, pose(0, -1, 2));
  expect_pose(link(robot, "tip").X_ML, pose(0, 0, 3));
  EXPECT_EQ(robot.joints.at(0).child, "inner::l") << "a nested model stands for its canonical link";
}

TEST(SdfFrames, AnglesMayBeDegreesOrQuaternions) {
  const RobotModel robot = model(
      "<link name='a'><pose degrees='true'>0 0 0 0 0 90</pose></link>"
      "<link name='b'><pose rotation_format='quat_xyzw'>0 0 0  0 0 0.7071067811865476 "
      "0.7071067811865476</pose></link>");
  expect_pose(link(robot, "a").X_ML, pose(0, 0, 0, kQuarter));
  expect_pose(link(robot, "b").X_ML, pose(0, 0, 0, kQuarter));
}

TEST(SdfFrames, AShapeAndAMassMayStandElsewhereInTheLink) {
  const RobotModel robot = model(
      "<frame name='f'><pose>5 0 0 0 0 0</pose></frame><link name='a'><pose>1 0 0 0 0 "
      "1.5707963267948966</pose>"
      "<inertial><mass>2</mass><pose>0 0 1 0 0 "
      "1.5707963267948966</pose><inertia><ixx>1</ixx><iyy>2</iyy><izz>2.5</izz>"
      "</inertia></inertial><collision name='c'><pose relative_to='f'>0 0 0 0 0 "
      "0</pose><geometry><sphere><radius>1"
      "</radius></sphere></geometry></collision></link>");
  const RobotLink& a = link(robot, "a");
  expect_pose(a.shapes.at(0).X_LS, pose(0, -4, 0, -kQuarter));
  EXPECT_EQ(a.mass.com, Eigen::Vector3d(0, 0, 1));
  EXPECT_NEAR(a.mass.inertia_C(0, 0), 2.0, 1e-12);
  EXPECT_NEAR(a.mass.inertia_C(1, 1), 1.0, 1e-12);
}

TEST(SdfFrames, AJointMayHaveTheNameOfALink) {
  const RobotModel robot = model(std::string(kTwo) +
                                 "<joint name='b' type='ball'><parent>a</parent><child>b</child></joint>"
                                 "<link name='c'><pose relative_to='b'>0 0 1 0 0 0</pose></link>");
  EXPECT_EQ(robot.joints.at(0).joint.name, "b");
  expect_pose(link(robot, "c").X_ML, pose(1, 2, 1, kQuarter));
}

TEST(SdfFrames, WhatNothingUsesMayBeWrong) {
  EXPECT_EQ(error_of(std::string(kTwo) + "<frame name='f' attached_to='nobody'/>"), "no error");
}

TEST(SdfFrames, SaysWhatIsWrongAndWhere) {
  const auto linked = [](const std::string& frame) {
    return "<link name='a'>\n<pose relative_to='" + frame + "'/></link>\n";
  };
  EXPECT_THAT(error_of(linked("arm") + "<frame name='arn'/>"), HasSubstr("m.sdf:1: link 'a': "));
  EXPECT_THAT(error_of(linked("arm") + "<frame name='arn'/>"), HasSubstr("'arm'; did you mean 'arn'?"));
  EXPECT_THAT(error_of(linked("a")), HasSubstr("the frame 'a' is relative to itself"));
  EXPECT_THAT(error_of(linked("f") + "<frame name='f'><pose relative_to='a'/></frame>"),
              HasSubstr("relative to itself"));
  EXPECT_THAT(
      error_of(std::string(kTwo) + "<frame name='f' attached_to='g'/><frame name='g' attached_to='f'/>"
                                   "<joint name='j' type='fixed'><parent>a</parent><child>f</child></joint>"),
      HasSubstr("relative to itself"));
  EXPECT_THAT(error_of("<link name='a'/><link name='a'/>"), HasSubstr("the name 'a' is given twice"));
  EXPECT_THAT(error_of("<link/>"), HasSubstr("needs a name"));
  EXPECT_THAT(error_of("<link name='a'><pose>1 2 3</pose></link>"),
              HasSubstr("must hold 6 numbers, holds 3"));
  EXPECT_THAT(error_of("<link name='a'><pose rotation_format='axis'>1 2 3 4 5 6</pose></link>"),
              HasSubstr("rotation_format must be euler_rpy or quat_xyzw"));
  EXPECT_THAT(
      error_of("<link name='a'/><joint name='j' type='fixed'><parent>a</parent><child>b</child></joint>"),
      HasSubstr("'b'"));
  EXPECT_THAT(error_of("<link name='a'/><joint name='j' type='fixed'><parent>a</parent></joint>"),
              HasSubstr("needs a <child>"));
}

TEST(SdfFrames, JointsThatMeanNothingAreLost) {
  const RobotModel robot =
      model("<link name='a'/><joint name='j' type='fixed'><parent>a</parent><child>a</child></joint>");
  EXPECT_TRUE(robot.joints.empty());
  EXPECT_THAT(robot.losses.back().text, HasSubstr("its parent and child are one link"));
}

TEST(SdfFrames, AJointWithoutAxisMovesAlongZ) {
  const RobotModel robot = model(
      "<link name='a'/><link name='b'/><joint name='j' "
      "type='revolute'><parent>a</parent><child>b</child></joint>");
  ASSERT_EQ(robot.joints.size(), 1u);
  EXPECT_EQ(robot.joints[0].joint.axis_J, Eigen::Vector3d::UnitZ());
  EXPECT_THAT(robot.losses.back().text, HasSubstr("joint 'j' gives no <axis>"));
}

TEST(SdfFrames, SizesThatAreMissingAreTheFormats) {
  const RobotModel robot = model(
      "<link name='a'><collision name='c'><geometry><box/></geometry></collision>"
      "<collision name='d'><geometry><capsule/></geometry></collision></link>");
  EXPECT_EQ(link(robot, "a").shapes.at(0).size, (std::array<double, 3>{1, 1, 1}));
  EXPECT_EQ(link(robot, "a").shapes.at(1).size, (std::array<double, 3>{0.5, 1, 0}));
  EXPECT_THAT(robot.losses.back().text, HasSubstr("gives no <length>: SDF's default is used"));
}

}  // namespace
}  // namespace visum::scene

// Joints that follow others (a URDF's <mimic>): a gripper of two fingers, and who may follow whom.
#include "server/cycle/follow.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/cycle/simulation.h"
#include "tests/support/temp_files.h"

namespace visum::cycle {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

std::string link(const std::string& name, const std::string& collision) {
  return "<link name='" + name +
         "'><inertial><mass value='0.5'/><inertia ixx='1e-3' iyy='1e-3' izz='1e-3' ixy='0' ixz='0' "
         "iyz='0'/></inertial>" +
         collision + "</link>";
}

std::string pad(const std::string& y) {
  return "<collision><origin xyz='0 " + y +
         " 0'/><geometry><box size='0.04 0.02 0.03'/></geometry></collision>";
}

std::string slider(const std::string& name, const std::string& ends, const std::string& axis,
                   const std::string& more) {
  return "<joint name='" + name + "' type='prismatic'>" + ends + "<axis xyz='" + axis +
         "'/><limit lower='0' upper='0.2' effort='40' velocity='0.1'/>" + more + "</joint>";
}

// A hand that a lift raises, with a finger on each side of y = 0. At 0 the fingers touch.
std::string gripper(const std::string& mimic) {
  return "<robot name='g'><link name='base'/>" + link("hand", "") + link("left", pad("0.01")) +
         link("right", pad("-0.01")) +
         slider("lift", "<parent link='base'/><child link='hand'/>", "0 0 1", "") +
         slider("l", "<parent link='hand'/><child link='left'/>", "0 1 0", "") +
         slider("r", "<parent link='hand'/><child link='right'/>", "0 -1 0", mimic) + "</robot>";
}

const std::string kMimic = "<mimic joint='l' multiplier='1' offset='0'/>";

// The box stands on a table, 5 mm off the middle, so that one finger meets it first.
scene::Scene scene_with(const std::string& engine, const std::string& part, const std::string& mimic) {
  const test::TempFiles files;
  files.write("g.urdf", gripper(mimic));
  return scene::load_scene(files.write("s.yaml", "visum: 1\nengine: " + engine + R"(
models: [{name: g, file: g.urdf, pose: {xyz: [0, 0, 0.52]}, joints: {l: 0.04}}]
parts: [{name: g, kind: ideal_joints, model: g)" + part +
                                                     R"(}]
bodies:
  - {name: table, fixed: true, pose: {xyz: [0, 0, 0.25]}, shapes: [{box: [0.5, 0.5, 0.5]}]}
  - {name: box, mass: 0.3, pose: {xyz: [0, 0.005, 0.52]}, shapes: [{box: [0.04, 0.04, 0.04]}]}
)"));
}

double position(const Simulation& simulation, const std::string& joint) {
  return simulation.state().joints[simulation.model().find_joint(joint).index()].position;
}

// The largest gap between the fingers' positions in so many ticks.
double largest_gap(Simulation& simulation, int ticks) {
  double largest = 0.0;
  for (int i = 0; i < ticks; ++i) {
    simulation.tick();
    largest = std::max(largest, std::abs(position(simulation, "g/l") - position(simulation, "g/r")));
  }
  return largest;
}

class Gripper : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Engines, Gripper, testing::Values("impulse", "ode"),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(Gripper, ItsFingersCloseTogetherAndLiftABox) {
  Simulation simulation(scene_with(GetParam(), "", kMimic));
  ASSERT_EQ(simulation.parts()[0].joints.size(), 2u) << "the finger that follows has no port";
  EXPECT_EQ(position(simulation, "g/r"), 0.04) << "it starts where it would follow to";
  simulation.write_inputs(0, 1, std::vector{0.015});
  EXPECT_LT(largest_gap(simulation, 1500), 5e-4) << "while it closes";
  EXPECT_NEAR(position(simulation, "g/l"), 0.02, 1e-3) << "half of the box";
  simulation.write_inputs(0, 0, std::vector{0.1});
  EXPECT_LT(largest_gap(simulation, 3000), 5e-4) << "while it lifts";
  EXPECT_EQ(simulation.fault(), "");
  EXPECT_NEAR(position(simulation, "g/lift"), 0.1, 1e-3);
  const auto box = simulation.model().find_body("box");
  EXPECT_NEAR(simulation.state().bodies[box.index()].p_WC.z(), 0.62, 5e-3);
}

TEST(Gripper, WithoutMimicTheOtherFingerStays) {
  Simulation simulation(scene_with("impulse", ", joints: [lift, l]", ""));
  simulation.write_inputs(0, 1, std::vector{0.015});
  EXPECT_GT(largest_gap(simulation, 1500), 1e-2);
}

TEST(Follower, GoesToMultiplierTimesPositionPlusOffset) {
  Simulation simulation(scene_with("impulse", "", "<mimic joint='l' multiplier='-0.5' offset='0.15'/>"));
  simulation.write_inputs(0, 1, std::vector{0.1});
  largest_gap(simulation, 2000);
  EXPECT_NEAR(position(simulation, "g/l"), 0.1, 1e-4);
  EXPECT_NEAR(position(simulation, "g/r"), 0.1, 1e-4);
  EXPECT_THAT(simulation.scene().notes, Contains(HasSubstr("joint 'r' follows 'l'")));
}

TEST(Follower, IsDrivenByThePartThatNamesIt) {
  const scene::Scene scene = scene_with("impulse", ", joints: [l, r]", kMimic);
  EXPECT_EQ(scene.parts[0].joints.size(), 2u);
  EXPECT_THAT(scene.followers, IsEmpty());
  EXPECT_THAT(scene.notes, Contains(HasSubstr("'g/r' does not follow 'g/l': part 'g' drives it")));
}

TEST(Follower, IsALossWhereItCannotFollow) {
  const auto losses = [](const std::string& mimic) { return scene_with("impulse", "", mimic).losses; };
  EXPECT_THAT(losses("<mimic joint='x'/>"), Contains(HasSubstr("there is no movable joint 'x' to follow")));
  EXPECT_THAT(losses("<mimic joint='r'/>"), Contains(HasSubstr("it would follow itself")));
  EXPECT_THAT(losses("<mimic joint='l' offset='1e9'/>"), Contains(HasSubstr("beyond 1e6")));
}

}  // namespace
}  // namespace visum::cycle

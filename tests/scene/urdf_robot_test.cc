// Links, shapes and colours of a URDF, as they are read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/scene/robot_model.h"
#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string kMass = "<mass value='2'/><inertia ixx='1' iyy='2' izz='2.5' ixy='0' ixz='0' iyz='0'/>";

class UrdfRobot : public testing::Test {
 protected:
  // A robot of one link that moves, with `in_link` in it.
  Scene load(const std::string& in_link, const std::string& origin, const std::string& more = "") {
    files_.write("m.urdf", "<robot name='r'><link name='base'/>" + more + "<link name='arm'><inertial>" +
                               origin + kMass + "</inertial>" + in_link +
                               "</link><joint name='turn' type='continuous'><origin xyz='0 0 3'/>"
                               "<parent link='base'/><child link='arm'/><axis xyz='0 0 1'/></joint></robot>");
    return load_scene(files_.write("s.yaml", "visum: 1\nmodels: [{name: m, file: m.urdf}]"));
  }
  static const world::Body& arm_of(const Scene& scene) { return scene.world.bodies.back(); }

  test::TempFiles files_;
};

TEST_F(UrdfRobot, AnInertialsAxesAreTurnedIntoTheLinks) {
  const Scene scene = load("", "<origin xyz='0.1 0.2 0.3' rpy='0 0 1.5707963267948966'/>");
  const world::Body& arm = arm_of(scene);
  EXPECT_EQ(arm.mass_kg, 2.0);
  EXPECT_NEAR(arm.inertia_C(0, 0), 2.0, 1e-12);
  EXPECT_NEAR(arm.inertia_C(1, 1), 1.0, 1e-12);
  EXPECT_NEAR(arm.inertia_C(2, 2), 2.5, 1e-12);
}

TEST_F(UrdfRobot, ACapsuleCollides) {
  const Scene scene =
      load("<collision><geometry><capsule radius='0.1' length='0.5'/></geometry></collision>", "");
  ASSERT_EQ(scene.world.shapes.size(), 1u);
  EXPECT_EQ(scene.world.shapes[0].kind, world::ShapeKind::kCapsule);
  EXPECT_EQ(scene.world.shapes[0].size[0], 0.1);
  EXPECT_EQ(scene.world.shapes[0].size[1], 0.5);
}

TEST_F(UrdfRobot, ACollisionOfAnUnknownFormIsALoss) {
  const Scene scene = load(
      "<collision name='c'><geometry><cdf/></geometry></collision>"
      "<collision name='d'><geometry/></collision>",
      "");
  EXPECT_TRUE(scene.world.shapes.empty());
  EXPECT_THAT(
      scene.losses,
      ElementsAre(HasSubstr("collision 'c' of link 'arm' collides with nothing: it has the form <cdf>"),
                  HasSubstr("collision 'd' of link 'arm' collides with nothing: it has no form")));
}

TEST_F(UrdfRobot, AMaterialIsKnownByItsName) {
  const Scene scene = load("<visual><geometry><sphere radius='1'/></geometry><material name='sky'/></visual>",
                           "", "<material name='sky'><color rgba='0 0.5 1 1'/></material>");
  ASSERT_EQ(scene.world.shapes.size(), 1u);
  EXPECT_EQ(scene.world.shapes[0].color[1], 0.5);
  EXPECT_EQ(scene.world.shapes[0].color[2], 1.0);
}

}  // namespace
}  // namespace visum::scene

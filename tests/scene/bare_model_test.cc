// A model file without a scene: a floor and a part come by themselves.
#include <gtest/gtest.h>

#include "server/scene/all_errors.h"
#include "server/scene/bare_model.h"
#include "server/scene/convert/convert.h"
#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

const std::string kOneKg =
    "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";

std::string arm(const std::string& in_base) {
  return "<robot name='r'><link name='base'>" + in_base + "</link><link name='arm'>" + kOneKg +
         "</link><joint name='turn' type='revolute'><parent link='base'/><child link='arm'/>"
         "<axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='7' velocity='2'/></joint></robot>";
}

TEST(BareModel, GetsAFloorAndAPartWithItsLimits) {
  const test::TempFiles files;
  const Scene scene = load_scene(files.write("my robot.urdf", arm("")));
  EXPECT_EQ(scene.name, "my robot");
  EXPECT_EQ(scene.world.bodies[0].name, "my_robot/base");
  EXPECT_TRUE(scene.world.bodies[0].fixed);
  ASSERT_EQ(scene.world.shapes.size(), 1u);
  EXPECT_EQ(scene.world.shapes[0].kind, world::ShapeKind::kPlane);
  ASSERT_EQ(scene.parts.size(), 1u);
  EXPECT_EQ(scene.parts[0].kind, "ideal_joints");
  ASSERT_EQ(scene.parts[0].context.joints.size(), 1u);
  EXPECT_EQ(scene.parts[0].context.joints[0].maximum_effort, 7);
  EXPECT_EQ(scene.parts[0].context.joints[0].maximum_speed, 2);
}

TEST(BareModel, StandsOnAFloorBelowItsLowestPoint) {
  const test::TempFiles files;
  const auto floor_of = [&](const std::string& geometry, const std::string& rpy) {
    const Scene scene =
        load_scene(files.write("r.urdf", arm("<collision><origin xyz='0 0 0.1' rpy='" + rpy +
                                             "'/><geometry>" + geometry + "</geometry></collision>")));
    return scene.world.bodies.back().X_WB.p.z();
  };
  EXPECT_DOUBLE_EQ(floor_of("<box size='1 1 1'/>", "0 0 0"), -0.4);
  EXPECT_DOUBLE_EQ(floor_of("<sphere radius='0.3'/>", "0 0 0"), -0.2);
  EXPECT_DOUBLE_EQ(floor_of("<box size='0.1 0.1 0.1'/>", "0 0 0"), 0.0) << "never above the origin";
  EXPECT_NEAR(floor_of("<box size='1 1 2'/>", "1.5707963267948966 0 0"), -0.4, 1e-12);
  EXPECT_DOUBLE_EQ(floor_of("<cylinder radius='0.3' length='0.4'/>", "0 0 0"), -0.1);
  EXPECT_NEAR(floor_of("<cylinder radius='0.3' length='0.4'/>", "1.5707963267948966 0 0"), -0.2, 1e-12);
  EXPECT_NEAR(floor_of("<capsule radius='0.1' length='0.4'/>", "0 0 0"), -0.2, 1e-12);
}

TEST(BareModel, WithoutJointsHasNoPart) {
  const test::TempFiles files;
  EXPECT_TRUE(load_scene(files.write("r.urdf", "<robot name='r'><link name='a'/></robot>")).parts.empty());
}

TEST(BareModel, MayHaveItsExtensionInCapitals) {
  const test::TempFiles files;
  EXPECT_EQ(load_scene(files.write("R.URDF", arm(""))).parts.size(), 1u);
  EXPECT_TRUE(is_model_file("a.SDF"));
  EXPECT_TRUE(is_x3d_file("a.X3D"));
  EXPECT_FALSE(is_model_file("a.YAML"));
}

TEST(BareModel, AsksForOverlapsToBeLeftOut) {
  const test::TempFiles files;
  EXPECT_TRUE(load_scene(files.write("r.urdf", arm(""))).models[0].overlaps_never_collide);
}

TEST(BareModel, TellsAllErrorsOfItsFile) {
  const test::TempFiles files;
  std::vector<config::ConfigError> errors;
  const std::string wrong = "<collision><geometry><box/></geometry></collision>";
  EXPECT_FALSE(load_scene(files.write("r.urdf", arm(wrong + "\n" + wrong)), {}, errors));
  ASSERT_EQ(errors.size(), 2u);
  EXPECT_EQ(errors[1].place().line, 2);
}

}  // namespace
}  // namespace visum::scene

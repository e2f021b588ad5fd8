// Surfaces, joints, springs and repairs of SDF models.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

class SdfModel : public testing::Test {
 protected:
  Scene bare(const std::string& inside, const std::string& version = "1.7") {
    return load_scene(files.write(
        "m.sdf", "<sdf version='" + version + "'><model name='m'>\n" + inside + "</model></sdf>"));
  }
  std::string error(const std::string& inside) {
    return files.error_of([&] { bare(inside); });
  }
  test::TempFiles files;
};

std::string solid(const std::string& surface) {
  return "<link name='l'><collision name='c'><geometry><box><size>1 1 1</size></box></geometry><surface>" +
         surface + "</surface></collision></link>";
}

std::string two_links(const std::string& joint, const std::string& inertial = "") {
  return "<link name='a'/><link name='b'>" + inertial + "</link>\n" + joint;
}

std::string joint(const std::string& type, const std::string& inside) {
  return "<joint name='j' type='" + type + "'><parent>a</parent><child>b</child>" + inside + "</joint>";
}

world::Surface surface_of(const Scene& scene) {
  return scene.world.surfaces.at(scene.world.shapes.at(0).surface.index());
}

TEST_F(SdfModel, FrictionAndRestitutionAct) {
  const world::Surface ode =
      surface_of(bare(solid("<friction><ode><mu>0.4</mu><mu2>0.4</mu2></ode></friction>"
                            "<bounce><restitution_coefficient>0.3</restitution_coefficient></bounce>")));
  EXPECT_EQ(ode.friction, 0.4);
  EXPECT_EQ(ode.restitution, 0.3);
  EXPECT_EQ(
      surface_of(bare(solid("<friction><bullet><friction>0.6</friction></bullet></friction>"))).friction,
      0.6);
  EXPECT_EQ(surface_of(bare(solid("<friction><ode/></friction>"))).friction, 1.0) << "SDF's default";
  EXPECT_EQ(surface_of(bare(solid("<friction/>"))).friction, 0.8) << "the scene's default";
  EXPECT_EQ(surface_of(bare(solid("<friction><ode><mu>1e15</mu></ode></friction>"))).friction, 1e6);
  const world::Surface spins =
      surface_of(bare(solid("<friction><torsional><coefficient>0.5</coefficient><patch_radius>0.1</"
                            "patch_radius></torsional></friction>")));
  EXPECT_NEAR(spins.torsional_friction, 3 * 3.14159265358979 / 16 * 0.05, 1e-12);
}

TEST_F(SdfModel, TheScenesSurfaceComesBeforeTheFiles) {
  files.write("m.sdf", "<sdf version='1.7'><model name='m'>" +
                           solid("<friction><ode><mu>0.4</mu></ode></friction>") + "</model></sdf>");
  const Scene scene = load_scene(files.write("s.yaml",
                                             "visum: 1\nsurfaces: {ice: {friction: 0.01}}\n"
                                             "models: [{name: m, file: m.sdf, surface: ice}]\n"));
  EXPECT_EQ(surface_of(scene).friction, 0.01);
}

TEST_F(SdfModel, WhatASurfaceCannotDoIsALossOnce) {
  const Scene scene =
      bare(solid("<friction><ode><mu>0.4</mu><mu2>0.9</mu2></ode></friction>"
                 "<contact><ode><kp>1e5</kp><kd>1</kd></ode></contact>"));
  EXPECT_NEAR(surface_of(scene).friction, 0.6, 1e-12);
  EXPECT_THAT(scene.losses, Contains(HasSubstr("the geometric mean acts")));
  EXPECT_THAT(scene.losses, Contains(HasSubstr("<kp> is not read")));
  const std::string through = "<contact><collide_without_contact>1</collide_without_contact></contact>";
  const Scene ghost = bare(solid(through));
  EXPECT_EQ(ghost.world.shapes.size(), 1u) << "the floor's alone";
  EXPECT_THAT(ghost.losses, Contains(HasSubstr("do not touch anything")));
}

TEST_F(SdfModel, BallUniversalAndScrewJointsLoad) {
  EXPECT_EQ(bare(two_links(joint("ball", ""))).world.joints.at(0).kind, world::JointKind::kBall);
  const world::Joint universal =
      bare(two_links(joint("universal", "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2>")))
          .world.joints.at(0);
  EXPECT_EQ(universal.kind, world::JointKind::kUniversal);
  EXPECT_EQ(universal.axis2_J, Eigen::Vector3d::UnitY());
  const std::string axis = "<axis><xyz>0 0 1</xyz></axis>";
  const Scene screw = bare(two_links(joint("screw", "<screw_thread_pitch>0.01</screw_thread_pitch>" + axis)));
  EXPECT_EQ(screw.world.joints.at(0).pitch_m, 0.01);
  EXPECT_EQ(screw.world.engines[0].name, "impulse") << "the engine that has screws";
  const Scene old = bare(two_links(joint("screw", "<thread_pitch>-628.3185307179587</thread_pitch>" + axis)));
  EXPECT_NEAR(old.world.joints.at(0).pitch_m, 0.01, 1e-12);
  EXPECT_EQ(error(two_links(joint("screw", axis))), "m.sdf:3: joint 'j': needs a <screw_thread_pitch>");
}

const std::string kSprung =
    "<axis><xyz>0 0 1</xyz><dynamics><spring_stiffness>3</spring_stiffness>"
    "<spring_reference>0.5</spring_reference></dynamics></axis>";

TEST_F(SdfModel, ASpringAboutAHingeIsAJointBesideIt) {
  const Scene scene = bare(two_links(joint("revolute", kSprung)));
  ASSERT_EQ(scene.world.joints.size(), 2u);
  const world::Joint& spring = scene.world.joints[1];
  EXPECT_EQ(spring.kind, world::JointKind::kTorsionSpring);
  EXPECT_EQ(spring.name, "m/j_spring");
  EXPECT_EQ(spring.stiffness, 3.0);
  EXPECT_EQ(spring.rest, 0.5);
  EXPECT_EQ(scene.world.engines[0].name, "impulse");
}

TEST_F(SdfModel, ASpringThatTheEngineDoesNotHaveIsALoss) {
  files.write("m.sdf", "<sdf version='1.7'><model name='m'>" + two_links(joint("revolute", kSprung)) +
                           "</model></sdf>");
  const auto file = files.write("s.yaml", "visum: 1\nengine: ode\nmodels: [{name: m, file: m.sdf}]\n");
  const Scene scene = load_scene(file);
  EXPECT_EQ(scene.world.joints.size(), 1u);
  EXPECT_THAT(scene.losses, Contains(HasSubstr("engine 'ode' has no springs")));
  EXPECT_EQ(load_scene(file, {.engine = "impulse"}).world.joints.size(), 2u);
  EXPECT_THAT(bare(two_links(joint("prismatic", kSprung))).losses,
              Contains(HasSubstr("only hinges have springs")));
}

TEST_F(SdfModel, MimicIsALossWithItsLine) {
  const Scene scene = bare(two_links(joint("revolute", "<axis><xyz>0 0 1</xyz>\n<mimic joint='k'/></axis>")));
  ASSERT_THAT(scene.losses, Contains(HasSubstr("joint 'j' moves on its own: <mimic> is not simulated")));
  EXPECT_EQ(scene.warnings.at(2).remark.line, 4);
}

std::string inertial(const std::string& mass, const std::string& a, const std::string& b,
                     const std::string& c) {
  return "<inertial><mass>" + mass + "</mass><inertia><ixx>" + a + "</ixx><iyy>" + b + "</iyy><izz>" + c +
         "</izz></inertia></inertial><collision name='c'><geometry><box><size>1 1 1</size></box></geometry>"
         "</collision>";
}

const std::string kHinge = joint("revolute", "<axis><xyz>0 0 1</xyz></axis>");

TEST_F(SdfModel, InertiasThatNoSolidHasAreRepaired) {
  const Scene raised = bare(two_links(kHinge, inertial("2", "1", "1", "3")));
  EXPECT_NEAR(raised.world.bodies.at(1).inertia_C(0, 0), 1.5, 1e-6);
  ASSERT_EQ(raised.repairs.size(), 1u);
  EXPECT_THAT(raised.repairs[0].remark.text, HasSubstr("the smaller two are raised"));
  const Scene spread = bare(two_links(kHinge, inertial("6", "0", "0", "0")));
  EXPECT_NEAR(spread.world.bodies.at(1).inertia_C(2, 2), 1.0, 1e-9) << "6 kg in a cube of 1 m";
  const Scene filled = bare(two_links(kHinge, inertial("0", "1", "1", "1")));
  EXPECT_NEAR(filled.world.bodies.at(1).mass_kg, 1000.0, 1e-9);
  EXPECT_THAT(bare(two_links(kHinge, inertial("2", "1", "1", "1"))).repairs, IsEmpty());
}

TEST_F(SdfModel, OfWhatStandsStillMassesAreNotUsed) {
  const Scene scene = bare("<static>true</static><link name='a'>" + inertial("2", "1", "1", "9") + "</link>");
  EXPECT_THAT(scene.repairs, IsEmpty());
  EXPECT_THAT(scene.losses, IsEmpty());
}

TEST_F(SdfModel, RepairsCanBeRefused) {
  files.write("m.sdf", "<sdf version='1.7'><model name='m'>\n" +
                           two_links(kHinge, inertial("2", "1", "1", "3")) + "</model></sdf>");
  const auto file = files.write("s.yaml", "visum: 1\nmodels: [{name: m, file: m.sdf, repair: false}]\n");
  EXPECT_THAT(files.error_of([&] { load_scene(file); }),
              HasSubstr("m.sdf:2: link 'b' has moments of inertia"));
}

TEST_F(SdfModel, AnEllipsoidIsAConvexSolid) {
  const Scene scene = bare(
      "<link name='a'/><link name='b'><inertial auto='true'/><collision name='c'><geometry><ellipsoid>"
      "<radii>0.1 0.2 0.3</radii></ellipsoid></geometry></collision></link>" +
      kHinge);
  EXPECT_EQ(scene.world.shapes.at(0).kind, world::ShapeKind::kConvex);
  const double volume = 4.0 / 3.0 * 3.14159265 * 0.1 * 0.2 * 0.3;
  EXPECT_NEAR(scene.world.bodies.at(1).mass_kg / (1000 * volume), 1.0, 0.03) << "water, by the mesh's volume";
}

TEST_F(SdfModel, PointsThatCollideAreEnlarged) {
  const Scene scene = bare(
      "<link name='a'><collision name='c'><geometry><sphere><radius>1e-9</radius></sphere></geometry>"
      "</collision></link>");
  EXPECT_EQ(scene.world.shapes.at(0).size[0], 1e-6);
  EXPECT_EQ(scene.repairs.size(), 1u);
}

TEST_F(SdfModel, AGearboxIsALossAndARevolute2HasTwoAxes) {
  EXPECT_THAT(
      bare(two_links(kHinge + "<joint name='g' type='gearbox'><parent>a</parent><child>b</child></joint>"))
          .losses,
      Contains(HasSubstr("gearbox")));
  EXPECT_EQ(
      bare(two_links(joint("revolute2", "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2>")))
          .world.joints.at(0)
          .kind,
      world::JointKind::kUniversal);
}

TEST_F(SdfModel, VisualsThatCannotBeShownAreLeftOut) {
  const auto visual = [](const std::string& inside) { return "<visual name='v'>" + inside + "</visual>"; };
  const std::string box = "<geometry><box><size>1 1 1</size></box></geometry>";
  const Scene scene = bare(
      "<link name='a'>" + visual("<geometry><sphere><radius>0</radius></sphere></geometry>") + visual("") +
      visual(box + "<material><script><name>Gazebo/Red</name></script><diffuse>red</diffuse></material>") +
      visual(box) + "</link>");
  EXPECT_EQ(scene.losses.size(), 4u) << "and that the link has no <inertial>";
  EXPECT_EQ(scene.world.shapes.size(), 3u) << "two boxes and the floor";
}

}  // namespace
}  // namespace visum::scene

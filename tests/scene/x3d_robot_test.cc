// Prototypes, inlined files, uneven scales, and the robots that OpenHRP writes with prototypes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/scene/convert/convert.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

using testing::Contains;
using testing::HasSubstr;

const std::string kVrml = "#VRML V2.0 utf8\n";

std::array<double, 3> size_of_only_shape(const Scene& scene) {
  EXPECT_EQ(scene.world.shapes.size(), 1u);
  return scene.world.shapes.at(0).size;
}

TEST(X3dHeaders, OfEachVersionAreTaken) {
  const test::TempFiles files;
  for (const std::string header : {"#X3D V3.0 utf8", "#X3D V3.3 utf8", "#X3D V4.0 utf8", "#X3D V4.1 utf8",
                                   "#VRML V2.0 utf8 CosmoWorlds"})
    EXPECT_EQ(size_of_only_shape(read_any_scene(
                  files.write("a.x3dv", header + "\nShape { geometry Box { size 1 2 3 } }"), {})),
              (std::array<double, 3>{1, 2, 3}))
        << header;
}

TEST(X3dPrototypes, FillFieldsAndDefaultsThroughNestedPrototypes) {
  const test::TempFiles files;
  const auto scene = read_any_scene(files.write("a.wrl", kVrml + R"(
PROTO Brick [ field SFVec3f size 1 2 3 exposedField MFNode extra [ ] ] {
  Group { children [ Shape { geometry Box { size IS size } } Group { children IS extra } ] }
}
PROTO Pair [ field SFVec3f low 4 5 6 ] {
  Group { children [ Brick { size IS low } Brick { extra Transform { translation 7 0 0 children Brick { } } } ] }
}
Pair { }
Pair { low 9 9 9 })"),
                                    {});
  std::vector<double> widths, places;
  for (const auto& shape : scene.world.shapes) {
    widths.push_back(shape.size[0]);
    places.push_back(shape.X_BS.p.x());
  }
  EXPECT_THAT(widths, testing::ElementsAre(4, 1, 1, 9, 1, 1));
  EXPECT_THAT(places, testing::ElementsAre(0, 0, 7, 0, 0, 7));
}

TEST(X3dPrototypes, AreReadFromXmlToo) {
  const test::TempFiles files;
  const auto scene = read_any_scene(files.write("a.x3d", R"(<X3D><Scene>
<ProtoDeclare name='Brick'>
 <ProtoInterface><field name='size' type='SFVec3f' accessType='inputOutput' value='1 2 3'/></ProtoInterface>
 <ProtoBody><Shape><Box><IS><connect nodeField='size' protoField='size'/></IS></Box></Shape></ProtoBody>
</ProtoDeclare>
<Transform><ProtoInstance name='Brick'><fieldValue name='size' value='4 5 6'/></ProtoInstance></Transform>
</Scene></X3D>)"),
                                    {});
  EXPECT_EQ(size_of_only_shape(scene), (std::array<double, 3>{4, 5, 6}));
}

TEST(X3dPrototypes, ComeFromLocalFiles) {
  const test::TempFiles files;
  files.write("lib/bricks.wrl", kVrml +
                                    "PROTO Tile [ ] { Shape { } }\n"
                                    "PROTO Brick [ field SFVec3f size 1 2 3 ] "
                                    "{ Shape { geometry Box { size IS size } } }");
  const auto scene =
      read_any_scene(files.write("a.wrl", kVrml + "EXTERNPROTO B [ field SFVec3f size ] "
                                                  "[ \"urn:x\" \"lib/bricks.wrl#Brick\" ]\nB { size 3 2 1 }"),
                     {});
  EXPECT_EQ(size_of_only_shape(scene), (std::array<double, 3>{3, 2, 1}));
}

TEST(X3dInline, PutsFilesWhereTheyAreNamedWithNamesOfTheirOwn) {
  const test::TempFiles files;
  files.write("parts/box.wrl", "# made by hand\n" + kVrml +
                                   "DEF a Shape { geometry Box { } }\n"
                                   "Transform { translation 0 1 0 children USE a }");
  files.write("parts/both.wrl", kVrml + "Inline { url \"box.wrl\" }");
  const auto scene = read_any_scene(
      files.write("a.wrl",
                  kVrml +
                      "DEF a Transform { translation 2 0 0 children Inline { url [ \"parts/both.wrl\" ] } }\n"
                      "Inline { url \"parts/box.wrl\" }"),
      {});
  std::vector<std::string> places;
  for (const auto& shape : scene.world.shapes)
    places.push_back(std::to_string(static_cast<int>(shape.X_BS.p.x())) +
                     std::to_string(static_cast<int>(shape.X_BS.p.y())));
  EXPECT_THAT(places, testing::ElementsAre("20", "21", "00", "01"));
}

TEST(X3dInline, ErrorsNameTheFileThatIsInlined) {
  const test::TempFiles files;
  files.write("part.wrl", kVrml + "Shape {\n geometry Sphere { radius -1 } }");
  const auto file = files.write("a.wrl", kVrml + "Inline { url \"part.wrl\" }");
  EXPECT_EQ(files.error_of([&] { read_any_scene(file, {}); }),
            "part.wrl:3: Sphere: radius must be greater than 0");
}

TEST(X3dScale, UnevenScalesKeepFormsWhereTheyCan) {
  const test::TempFiles files;
  const auto scene = read_any_scene(files.write("a.wrl", kVrml + R"(
Transform { scale 1 2 3 children [
  Shape { geometry Box { size 1 1 1 } }
  Shape { geometry Sphere { } }
  Transform { rotation 0 0 1 0.5 children Shape { geometry Box { size 1 1 1 } } }
] }
Transform { scale 2 5 2 children Shape { geometry Cylinder { radius 1 height 1 } } })"),
                                    {});
  const auto& shapes = scene.world.shapes;
  ASSERT_EQ(shapes.size(), 4u);
  EXPECT_EQ(shapes[0].size, (std::array<double, 3>{1, 2, 3}));
  ASSERT_EQ(shapes[1].kind, world::ShapeKind::kConvex);
  Eigen::Vector3d most = Eigen::Vector3d::Zero();
  for (const auto& vertex : scene.world.meshes[shapes[1].mesh.index()].vertices)
    most = most.cwiseMax(vertex.cwiseAbs());
  EXPECT_TRUE(most.isApprox(Eigen::Vector3d(1, 2, 3), 1e-3)) << most.transpose();
  EXPECT_EQ(shapes[2].kind, world::ShapeKind::kConvex);  // sheared
  EXPECT_EQ(shapes[3].kind, world::ShapeKind::kCylinder);
  EXPECT_EQ(shapes[3].size[0], 2.0);
  EXPECT_EQ(shapes[3].size[1], 5.0);
}

// The prototypes as OpenHRP's models declare them, shortened.
const std::string kPrototypes = kVrml + R"(
PROTO Joint [
  exposedField MFNode children [ ]  exposedField SFVec3f translation 0 0 0  exposedField SFRotation rotation 0 0 1 0
  exposedField MFFloat llimit [ ]  exposedField MFFloat ulimit [ ]
  exposedField MFFloat lvlimit [ ]  exposedField MFFloat uvlimit [ ]
  exposedField SFString jointType ""  exposedField SFVec3f jointAxis 0 0 1
] { Transform { children IS children translation IS translation rotation IS rotation } }
PROTO Segment [
  exposedField MFNode children [ ]  exposedField SFFloat mass 0  exposedField SFVec3f centerOfMass 0 0 0
  exposedField MFFloat momentsOfInertia [ 0 0 0 0 0 0 0 0 0 ]
] { Group { children IS children } }
PROTO Gyro [ exposedField SFVec3f translation 0 0 0 ] { Transform { translation IS translation } }
PROTO Humanoid [ exposedField MFNode humanoidBody [ ]  exposedField MFNode joints [ ] ]
{ Transform { children [ Group { children IS humanoidBody } ] } }
)";

const std::string kArm = kPrototypes + R"(
DEF Arm Humanoid {
  humanoidBody DEF BASE Joint {
    jointType "fixed"
    translation 0 0 0.5
    children [
      DEF BASE_LINK Segment { mass 3 children Shape { geometry Box { size 0.2 0.2 1 } } }
      DEF SHOULDER Joint {
        jointType "rotate" jointAxis 0 2 0 translation 0 0 1 llimit -1 ulimit [ 2 ] lvlimit -4 uvlimit 4
        children [
          DEF UPPER Segment {
            mass 2 centerOfMass 0.1 0 0.3 momentsOfInertia [ 0.03 0 0 0 0.04 0 0 0 0.05 ]
            children Shape { geometry Box { size 0.1 0.1 0.6 } }
          }
          DEF gyro Gyro { }
          DEF HAND Joint {
            jointType "slide" jointAxis 1 0 0 rotation 0 0 1 1.5707963267948966 translation 0 0 0.6
            children Segment { mass 1 momentsOfInertia [ 0.01 0 0 0 0.01 0 0 0 0.01 ] }
          }
        ]
      }
    ]
  }
  joints [ USE BASE USE SHOULDER USE HAND ]
})";

TEST(X3dRobot, LinksHaveMassAndJointsHaveAxisAndLimits) {
  const test::TempFiles files;
  const auto scene = load_any(files.write("arm.wrl", kArm), {});
  const auto& world = scene.world;
  EXPECT_EQ(world.gravity, Eigen::Vector3d(0, 0, -9.81));
  ASSERT_EQ(world.bodies.size(), 3u);
  EXPECT_TRUE(world.bodies[0].fixed);
  const auto& upper = world.bodies[world.find_body("SHOULDER").index()];
  EXPECT_EQ(upper.mass_kg, 2.0);
  EXPECT_TRUE(upper.p_BC.isApprox(Eigen::Vector3d(0.1, 0, 0.3)));
  EXPECT_TRUE(upper.inertia_C.diagonal().isApprox(Eigen::Vector3d(0.03, 0.04, 0.05)));
  EXPECT_TRUE(upper.X_WB.p.isApprox(Eigen::Vector3d(0, 0, 1.5)));
  const auto& shoulder = world.joints[world.find_joint("SHOULDER").index()];
  EXPECT_EQ(shoulder.kind, world::JointKind::kHinge);
  EXPECT_EQ(shoulder.axis_J, Eigen::Vector3d::UnitY());
  EXPECT_TRUE(shoulder.limited);
  EXPECT_EQ(shoulder.lower, -1.0);
  EXPECT_EQ(shoulder.upper, 2.0);
  const auto& hand = world.joints[world.find_joint("HAND").index()];
  EXPECT_EQ(hand.kind, world::JointKind::kSlider);
  EXPECT_FALSE(hand.limited);
  EXPECT_EQ(world.bodies[hand.parent.index()].name, "SHOULDER");
  // Its axis is x of its own frame, which is turned by 90 degrees: y of the world.
  const Eigen::Vector3d axis_W = world.bodies[hand.parent.index()].X_WB.q * (hand.X_PJ.q * hand.axis_J);
  EXPECT_TRUE(axis_W.isApprox(Eigen::Vector3d::UnitY(), 1e-12));
}

TEST(X3dRobot, HasAPartThatDrivesItsJointsAndTellsWhatIsNotRead) {
  const test::TempFiles files;
  const auto scene = load_any(files.write("arm.wrl", kArm), {});
  ASSERT_EQ(scene.parts.size(), 1u);
  EXPECT_EQ(scene.parts[0].context.name, "Arm");
  EXPECT_EQ(scene.parts[0].kind, "ideal_joints");
  ASSERT_EQ(scene.parts[0].joints.size(), 2u);
  EXPECT_EQ(scene.parts[0].context.joints[0].maximum_speed, 4.0);
  EXPECT_THAT(scene.losses, Contains(HasSubstr("devices are not read: Gyro 'gyro'")));
  EXPECT_EQ(scene.world.no_collision.size(), 3u);  // no two of its links collide
}

TEST(X3dRobot, ConvertsToYamlThatLoads) {
  const test::TempFiles files;
  const auto yaml = files.folder() / "arm.yaml";
  convert(files.write("arm.wrl", kArm), yaml, {});
  const auto scene = load_scene(yaml);
  EXPECT_EQ(scene.world.joints.size(), 2u);
  EXPECT_EQ(scene.world.bodies[1].mass_kg, 2.0);
}

TEST(X3dRobot, TooManyLinksAreRefused) {
  const test::TempFiles files;
  std::string text = kPrototypes + "DEF Many Humanoid { humanoidBody [\n";
  for (int i = 0; i < 257; ++i) text += "Joint { jointType \"free\" }\n";
  const auto file = files.write("many.wrl", text + "] }");
  EXPECT_THAT(files.error_of([&] { read_any_scene(file, {}); }),
              HasSubstr("Joint: the robot has more than 256 links"));
}

}  // namespace
}  // namespace visum::scene

// Converts scenes between encodings: the result moves with the same bits, and losses are reported.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "server/cycle/simulation.h"
#include "server/scene/convert/convert.h"
#include "server/world/joint_kinds.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Everything that X3D can hold: turned and pushed solids, a mesh, a chain of joints, two surfaces.
const std::string kHeap = R"(
visum: 1
name: heap
gravity: [0, 0.3, -9.7]
tick_ms: 2
seed: 7
surfaces: {default: {friction: 0.6, restitution: 0.1}, ice: {friction: 0.02, restitution: 0.5}}
bodies:
  - {name: floor, fixed: true, pose: {xyz: [0, 0, -0.1]}, shapes: [{box: [8, 8, 0.2]}]}
  - {name: wall, fixed: true, pose: {xyz: [1, 0, 0.2], rpy: [0.1, 0.2, 0.3]}, shapes: [{cylinder: {radius: 0.2, length: 0.7}}]}
  - {name: ball, density: 700, pose: {xyz: [0.1, 0, 0.8]}, velocity: {linear: [0.7, 0.1, 0], angular: [1, 2, 3]},
     shapes: [{sphere: 0.07, surface: ice, color: [0.1, 0.2, 0.3, 0.5]}]}
  - {name: brick, density: 900, pose: {xyz: [-0.3, 0.4, 0.5], rpy: [0.3, -0.7, 1.1]},
     shapes: [{box: [0.2, 0.1, 0.06]}, {box: [0.05, 0.05, 0.3], pose: {xyz: [0.1, 0, 0], rpy: [0, 0.4, 0]}}, {sphere: 0.01, collides: false}]}
  - {name: wedge, density: 300, pose: {xyz: [0.4, -0.6, 0.4], rpy: [1, 2, 3]}, shapes: [{convex: wedge.obj, scale: 0.2}]}
  - {name: arm, mass: 0.4, inertia: [0.01, 0.02, 0.015, 0.001, 0, 0.002], com: [0.02, 0, 0.1], pose: {xyz: [0, 1.2, 0.7], rpy: [0.2, 0, 0.1]}}
  - {name: hand, mass: 0.2, inertia: [0.01, 0.01, 0.01, 0, 0, 0], pose: {xyz: [0, 1.5, 0.7]}}
  - {name: rod, mass: 0.1, inertia: [0.001, 0.001, 0.001, 0, 0, 0], pose: {xyz: [0.3, 1.5, 0.7]}}
  - {name: tip, mass: 0.1, inertia: [0.001, 0.001, 0.001, 0, 0, 0], pose: {xyz: [0.3, 1.5, 0.4]}}
joints:
  - {name: shoulder, type: hinge, child: arm, pose: {xyz: [0, 1, 0.7], rpy: [0.3, 0, 0]}, axis: [1, 0.2, 0], limits: [-1, 1.2],
     friction: 0.01, damping: 0.02, stop_restitution: 0.2, position: 0.1}
  - {name: wrist, type: universal, parent: arm, child: hand, pose: {xyz: [0, 0.2, 0]}, axis: [1, 0, 0], axis2: [0, 1, 0]}
  - {name: slide, type: slider, parent: hand, child: rod, axis: [1, 0, 0], limits: [-0.1, 0.2], damping: 3}
  - {name: end, type: ball, parent: rod, child: tip, pose: {xyz: [0, 0, -0.1]}}
)";

const std::string kWedge = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

std::string text_of(const std::filesystem::path& file) {
  std::stringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

std::vector<std::uint64_t> hashes(const std::filesystem::path& file, const std::string& engine) {
  Options options;
  options.engine = engine;
  cycle::Simulation simulation(load_scene(file, options));
  std::vector<std::uint64_t> all;
  for (int i = 0; i < 1000; ++i) {
    simulation.tick();
    all.push_back(simulation.state_hash());
  }
  EXPECT_EQ(simulation.fault(), "");
  return all;
}

struct Way {
  const char* name;
  const char* ending;
};

class RoundTrip : public testing::TestWithParam<Way> {};

TEST_P(RoundTrip, KeepsTheHashOfAThousandTicksWithBothEngines) {
  const test::TempFiles files;
  files.write("wedge.obj", kWedge);
  const auto first = files.write("heap.yaml", kHeap);
  const auto there = files.folder() / (std::string("there") + GetParam().ending);
  const auto back = files.folder() / "back.yaml";
  EXPECT_THAT(convert(first, there, {}), IsEmpty());
  EXPECT_THAT(convert(there, back, {}), IsEmpty());
  for (const char* engine : {"ode", "impulse"})
    EXPECT_EQ(hashes(first, engine), hashes(back, engine)) << engine;
}

// The text without the first line, which names the source file, and without the folder of meshes.
std::string content_of(const std::filesystem::path& file, const std::string& folder) {
  std::string text = text_of(file);
  if (text.starts_with("# Written")) text.erase(0, text.find('\n'));
  for (std::size_t at = text.find(folder); at != std::string::npos; at = text.find(folder))
    text.erase(at, folder.size());
  return text;
}

TEST_P(RoundTrip, ComesBackAsTheSameText) {
  const test::TempFiles files;
  files.write("wedge.obj", kWedge);
  const std::string ending = GetParam().ending;
  const auto a = files.folder() / ("a" + ending), b = files.folder() / ("b" + ending);
  convert(files.write("heap.yaml", kHeap), a, {});
  convert(a, b, {});
  EXPECT_EQ(content_of(a, "a.yaml_files"), content_of(b, "b.yaml_files"));
}

INSTANTIATE_TEST_SUITE_P(Formats, RoundTrip,
                         testing::Values(Way{"Yaml", ".yaml"}, Way{"X3dXml", ".x3d"},
                                         Way{"X3dClassic", ".x3dv"}),
                         [](const auto& info) { return info.param.name; });

TEST(Convert, OfModelsPartsAndSensorsYamlKeepsAll) {
  const test::TempFiles files;
  const std::filesystem::path scenes = std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes";
  for (const char* name : {"sensors.yaml", "two_link.yaml", "amtec_arm.yaml"}) {
    const auto copy = files.folder() / name;
    EXPECT_THAT(convert(scenes / name, copy, {}), IsEmpty()) << name;
    EXPECT_EQ(cycle::Simulation(load_scene(scenes / name)).state_hash(),
              cycle::Simulation(load_scene(copy)).state_hash())
        << name;
  }
}

TEST(Convert, OfModelsYamlKeepsThePairsThatNeverCollide) {
  const test::TempFiles files;
  const auto robot = std::filesystem::path(VISUM_SOURCE_DIR) / "tests/scene/data/robot.urdf";
  const auto entry = [&](const std::string& name) { return "{name: " + name + ", file: " + robot.string(); };
  const auto first =
      files.write("s.yaml", "visum: 1\nmodels:\n  - " + entry("arm") + "}\n  - " + entry("limp") +
                                ", pose: {xyz: [3, 0, 0]}, self_collision: false}\n"
                                "no_collision: [[arm/base, arm/finger], [arm/base, limp/finger]]\n");
  const auto back = files.folder() / "back.yaml";
  convert(first, back, {});
  EXPECT_EQ(load_scene(first).world.no_collision, load_scene(back).world.no_collision);
  EXPECT_THAT(text_of(back), testing::Not(HasSubstr("[\"limp/"))) << "the model's own entry says it";
}

TEST(Convert, SaysWhereYamlChangesTheOrderOfBodies) {
  const test::TempFiles files;
  const auto fleet = std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/cart_fleet.yaml";
  const auto copy = files.folder() / "fleet.yaml";
  EXPECT_THAT(convert(fleet, copy, {}), ElementsAre(HasSubstr("in one file models come before bodies")));
  const auto a = load_scene(fleet), b = load_scene(copy);
  EXPECT_EQ(a.parts.size(), b.parts.size());
  const auto& cart = a.world.bodies[a.world.find_body("cart_7/chassis").index()];
  const auto& same = b.world.bodies[b.world.find_body("cart_7/chassis").index()];
  EXPECT_EQ(cart.X_WB.p, same.X_WB.p);
  EXPECT_EQ(cart.X_WB.q.coeffs(), same.X_WB.q.coeffs());
}

// A wheel with a drive, which turns, and a rod that passes through its surroundings.
std::string driven() {
  const auto drives = std::filesystem::path(VISUM_SOURCE_DIR) / "models/cart/drives.yaml";
  return R"(
visum: 1
name: driven
bodies:
  - {name: frame, mass: 2, inertia: [0.1, 0.1, 0.1, 0, 0, 0], pose: {xyz: [0, 0, 1]}, shapes: [{box: [0.4, 0.1, 0.1]}]}
  - {name: wheel, density: 500, pose: {xyz: [0, 0.2, 1]}, shapes: [{cylinder: {radius: 0.1, length: 0.05}}]}
  - {name: rod, density: 500, pose: {xyz: [0.1, 0, 1.01]}, shapes: [{box: [0.02, 0.02, 0.3]}]}
joints: [{name: rear_left_axle, type: hinge, parent: frame, child: wheel, pose: {xyz: [0, 0.2, 0]}, axis: [0, 1, 0]}]
no_collision: [[frame, rod]]
parts: [{name: motor, kind: servo_group, joints: [rear_left_axle], drives: ")" +
         drives.string() + "\"}]\n";
}

std::vector<std::uint64_t> hashes_driven(const std::filesystem::path& file) {
  cycle::Simulation simulation(load_scene(file));
  std::vector<double> inputs = simulation.parts().front().controller_inputs;
  inputs.front() = 5.0;  // Desired Speed 1
  simulation.write_inputs(0, 0, inputs);
  std::vector<std::uint64_t> all;
  for (int i = 0; i < 1000; ++i) {
    simulation.tick();
    all.push_back(simulation.state_hash());
  }
  EXPECT_GT(std::abs(simulation.state().joints[0].position), 1.0) << "it has turned";
  return all;
}

TEST(Convert, MotorsKeepTheHashOfAThousandTicksThroughX3d) {
  const test::TempFiles files;
  const auto first = files.write("driven.yaml", driven());
  for (const char* ending : {".x3d", ".x3dv"}) {
    const auto there = files.folder() / (std::string("there") + ending), back = files.folder() / "back.yaml";
    EXPECT_THAT(convert(first, there, {}), IsEmpty());
    EXPECT_THAT(convert(there, back, {}), IsEmpty());
    EXPECT_EQ(hashes_driven(first), hashes_driven(back)) << ending;
  }
}

TEST(Convert, AMotorThatAnEditorTakesAwayDrivesNothing) {
  const test::TempFiles files;
  convert(files.write("driven.yaml", driven()), files.folder() / "d.x3d", {});
  std::string text = text_of(files.folder() / "d.x3d");
  const auto begin = text.find("<MotorJoint"), end = text.find("</MotorJoint>");
  ASSERT_NE(begin, std::string::npos);
  EXPECT_THAT(text.substr(begin, end - begin), HasSubstr("motor1Axis=\"0 1 0\""));
  text.erase(begin, end + std::string("</MotorJoint>").size() - begin);
  const auto scene = read_any_scene(files.write("d.x3d", text), {});
  EXPECT_THAT(scene.parts, IsEmpty());
  EXPECT_THAT(scene.losses,
              ElementsAre(HasSubstr(
                  "part 'motor' is not read: the joint 'rear_left_axle' has no MotorJoint any more")));
}

TEST(Convert, TheCartKeepsItsDrivesThroughX3d) {
  const test::TempFiles files;
  const auto cart = std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/cart.yaml";
  const auto there = files.folder() / "cart.x3d", back = files.folder() / "cart.yaml";
  const auto losses = convert(cart, there, {});
  EXPECT_THAT(losses, testing::Contains(HasSubstr("X3D has no models: the links and joints of 'cart'")));
  EXPECT_THAT(losses, testing::Not(testing::Contains(HasSubstr("hardware parts"))));
  convert(there, back, {});
  cycle::Simulation simulation(load_scene(back));
  ASSERT_EQ(simulation.parts().size(), 1u);
  EXPECT_EQ(simulation.parts()[0].part->description().controller_inputs.size(),
            cycle::Simulation(load_scene(cart)).parts()[0].part->description().controller_inputs.size());
}

TEST(Convert, SaysWhatX3dCannotHold) {
  const test::TempFiles files;
  const auto file = files.write("s.yaml", R"(
visum: 1
bodies:
  - {name: floor, fixed: true, shapes: [{plane: true, name: ground}]}
  - {name: pill, mass: 1, pose: {xyz: [0, 0, 1]}, shapes: [{capsule: {radius: 0.1, length: 0.2}, name: skin}]}
joints: [{name: weld, type: fixed, child: pill}]
sensors: [{name: eye, kind: distance, range: [0.1, 2]}]
)");
  EXPECT_THAT(convert(file, files.folder() / "s.x3d", {}),
              ElementsAre("X3D has no planes: 'ground' is a slab of 200 m by 200 m by 1 m",
                          "X3D has no capsules: 'skin' is a cylinder with two balls",
                          "X3D has no joint of type fixed: 'weld' is left out",
                          "X3D has no sensors of Visum's: 'eye' is left out"));
}

TEST(Convert, X3dKeepsTheSurfacesOfPlanesAndCapsulesAndPairsBesideSprings) {
  const test::TempFiles files;
  const auto file = files.write("s.yaml", R"(
visum: 1
surfaces: {ice: {friction: 0.01}}
bodies:
  - {name: ground, fixed: true, shapes: [{plane: true, surface: ice}]}
  - {name: pill, mass: 1, pose: {xyz: [0, 0, 1]}, shapes: [{capsule: {radius: 0.1, length: 0.2}, surface: ice}]}
  - {name: cube, mass: 1, pose: {xyz: [1, 0, 1]}, shapes: [{box: [0.1, 0.1, 0.1]}]}
  - {name: bead, mass: 1, pose: {xyz: [1, 0, 1.05]}, shapes: [{box: [0.1, 0.1, 0.1]}]}
joints:
  - {name: pull, type: spring, parent: cube, child: bead, child_point: [0, 0, 0], stiffness: 10, rest: 0.05}
  - {name: weld, type: fixed, parent: pill, child: cube}
no_collision: [[cube, bead]]
)");
  convert(file, files.folder() / "s.x3d", {});
  const auto scene = read_any_scene(files.folder() / "s.x3d", {});
  EXPECT_EQ(scene.world.no_collision, load_scene(file).world.no_collision);
  ASSERT_EQ(scene.world.shapes.size(), 6u) << "a slab, a cylinder with two balls, two boxes";
  for (std::size_t i = 0; i < 6; ++i)
    EXPECT_EQ(scene.world.surfaces[scene.world.shapes[i].surface.index()].name, i < 4 ? "ice" : "default");
}

TEST(Convert, WhatAnEditorMovesStaysMoved) {
  const test::TempFiles files;
  const auto file = files.write(
      "s.yaml",
      "visum: 1\nbodies: [{name: b, fixed: true, pose: {xyz: [1, 2, 3]}, shapes: [{sphere: 1}]}]\n");
  convert(file, files.folder() / "s.x3d", {});
  std::string text = text_of(files.folder() / "s.x3d");
  const std::string place = "position=\"1 2 3\"";
  ASSERT_THAT(text, HasSubstr(place));
  text.replace(text.find(place), place.size(), "position=\"1 2 5\"");
  const auto moved = read_any_scene(files.write("moved.x3d", text), {});
  EXPECT_EQ(moved.world.bodies.at(0).X_WB.p, Eigen::Vector3d(1, 2, 5));
}

TEST(Convert, ReadsAVrmlWorldAsScenery) {
  const test::TempFiles files;
  const auto file = files.write("room.wrl", R"(#VRML V2.0 utf8
DEF Brick Shape { appearance Appearance { material Material { diffuseColor 1 0.5 0 } } geometry Box { size 1, 2, 3 } }
Transform {  # turned by 90 degrees, twice as large
  translation 0 5 0 rotation 0 0 1 1.5707963267948966 scale 2 2 2
  children [ USE Brick  Transform { translation 1 0 0 children Shape { geometry Cylinder { radius 0.5 height 2 } } } ]
}
Viewpoint { position 0 1 10 description "Front" }
)");
  const auto scene = read_any_scene(file, {});
  ASSERT_EQ(scene.world.bodies.size(), 1u);
  ASSERT_EQ(scene.world.shapes.size(), 3u);
  EXPECT_EQ(scene.world.shapes[1].size, (std::array<double, 3>{2, 4, 6}));
  EXPECT_TRUE(scene.world.shapes[2].X_BS.p.isApprox(Eigen::Vector3d(0, 7, 0), 1e-12));
  EXPECT_EQ(scene.world.shapes[2].size[1], 4.0);
  // The cylinder's axis is z here and y in its node; the node is turned so that it points to -x.
  EXPECT_TRUE(
      (scene.world.shapes[2].X_BS.q * Eigen::Vector3d::UnitZ()).isApprox(-Eigen::Vector3d::UnitX(), 1e-12));
  EXPECT_EQ(scene.looks.viewpoints.at(0).name, "Front");
  EXPECT_EQ(scene.world.gravity, Eigen::Vector3d(0, -9.81, 0));
}

TEST(Convert, ReadsRigidBodiesAsOthersWriteThem) {
  const test::TempFiles files;
  const auto file = files.write("swing.x3d", R"(<?xml version="1.0" encoding="UTF-8"?>
<!DOCTYPE X3D PUBLIC "ISO//Web3D//DTD X3D 3.2//EN" "http://www.web3d.org/specifications/x3d-3.2.dtd">
<X3D profile='Immersive' version='3.2'><head/><Scene>
 <RigidBodyCollection gravity='0 -9.8 0'>
  <RigidBody DEF='Seat' mass='2' position='0 -1 0' inertia='0.1 0 0 0 0.2 0 0 0 0.3'>
   <CollidableShape><Shape><Box size='0.5 0.1 0.3'/></Shape></CollidableShape>
  </RigidBody>
  <RigidBody DEF='Beam' fixed='true'/>
  <SingleAxisHingeJoint anchorPoint='0 0 0' axis='0 0 1' minAngle='-1' maxAngle='0.5'>
   <RigidBody USE='Seat' containerField='body1'/><RigidBody USE='Beam' containerField='body2'/>
  </SingleAxisHingeJoint>
  <MotorJoint enabledAxes='1'/>
 </RigidBodyCollection>
</Scene></X3D>)");
  const auto scene = read_any_scene(file, {});
  ASSERT_EQ(scene.world.joints.size(), 1u);
  const auto& joint = scene.world.joints[0];
  EXPECT_EQ(scene.world.bodies[joint.child.index()].name, "Seat");
  EXPECT_EQ(scene.world.bodies[joint.parent.index()].name, "Beam");
  EXPECT_EQ(joint.axis_J, Eigen::Vector3d(0, 0, -1));  // the child comes first in the file
  EXPECT_EQ(joint.lower, -1.0);
  EXPECT_THAT(scene.losses, ElementsAre(HasSubstr("a MotorJoint is not read")));
  const auto yaml = files.folder() / "swing.yaml";
  convert(file, yaml, {});
  EXPECT_EQ(load_scene(yaml).world.joints[0].X_CJ.p, Eigen::Vector3d(0, 1, 0));
}

TEST(Convert, ReadsNoOtherFilesAndNoCode) {
  const test::TempFiles files;
  const auto refusal = [&](const std::string& name, const std::string& text) {
    const auto file = files.write(name, text);
    return files.error_of([&] { read_any_scene(file, {}); });
  };
  EXPECT_EQ(refusal("a.wrl", "#VRML V2.0 utf8\nInline { url \"/etc/passwd\" }"),
            "a.wrl:2: Inline: '/etc/passwd' is not a file of X3D or VRML97");
  EXPECT_EQ(refusal("b.x3d", "<!DOCTYPE x [<!ENTITY a 'aaaa'>]>\n<X3D><Scene/></X3D>"),
            "b.x3d:1: a document type with declarations is not supported");
  EXPECT_EQ(refusal("a.txt", ""),
            "a.txt: its extension names its format and must be one of .yaml, .urdf, .sdf, .world, .xacro, "
            ".mjcf, .xml, .x3d, .x3dv, .wrl");
}

// A script moves what it is connected to. The world that it is written into stands without it.
TEST(Convert, ScriptsAreALossAndTheShapesBesideThemAreRead) {
  const test::TempFiles files;
  const auto read = [&](const std::string& name, const std::string& text) {
    return read_any_scene(files.write(name, text), {});
  };
  const auto classic = read("turn.wrl", R"(#VRML V2.0 utf8
PROTO Turner [ exposedField SFVec3f size 1 1 1 eventIn SFTime start ] {
  Transform { children [
    Shape { geometry Box { size IS size } }
    DEF Inner Script {
      eventIn SFTime begin IS start
      eventOut SFRotation turned
      field SFFloat speed 0.5
      field SFNode other DEF Ball Shape { geometry Sphere { radius 0.2 } }
      field MFString names [ "a" "b" ]
      directOutput TRUE
      url "javascript: function begin() { turned = 1; }"
    }
  ] }
}
Turner { size 2 2 2 }
DEF Second Script { field SFNode root USE Ball url "javascript: x" }
ROUTE Inner.turned TO Second.set
)");
  ASSERT_EQ(classic.world.shapes.size(), 1u);
  EXPECT_EQ(classic.world.shapes[0].size, (std::array<double, 3>{2, 2, 2}));
  EXPECT_THAT(classic.losses,
              ElementsAre("line 5: a Script is not read, nor are 1 more: what it would change "
                          "stays as it is written"));
  const auto xml = read("turn.x3d", R"(<X3D version='3.2'><Scene>
<Script DEF='S'><field name='speed' type='SFFloat' accessType='initializeOnly' value='0.5'/>
<field name='ball' type='SFNode' accessType='inputOutput'><Shape DEF='Ball'><Sphere radius='0.2'/></Shape></field>
<![CDATA[ecmascript: function x() {}]]></Script>
<Transform translation='1 0 0'><Shape USE='Ball'/></Transform>
</Scene></X3D>)");
  ASSERT_EQ(xml.world.shapes.size(), 1u);
  EXPECT_EQ(xml.world.shapes[0].X_BS.p, Eigen::Vector3d(1, 0, 0));
  EXPECT_THAT(xml.losses,
              ElementsAre("line 2: a Script is not read: what it would change stays as it is written"));
}

TEST(Convert, ExportsAndImportsOfX3dMayRename) {
  const test::TempFiles files;
  const auto scene = read_any_scene(files.write("names.x3dv", R"(#X3D V3.2 utf8
PROFILE Immersive
DEF Ball Shape { geometry Sphere { radius 0.2 } }
EXPORT Ball AS Sphere
EXPORT Ball
Transform { translation 1 0 0 children USE Ball }
)"),
                                    {});
  EXPECT_EQ(scene.world.shapes.size(), 2u);
}

}  // namespace
}  // namespace visum::scene

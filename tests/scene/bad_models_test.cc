// Wrong robot files: each is refused with file, line, name and reason.
#include <gtest/gtest.h>

#include "server/scene/robot_model.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

const std::string kSolid =
    "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";

std::string urdf_error(const std::string& text) {
  return test::TempFiles().error_of([&] { read_robot_model("m.urdf", text); });
}

// A robot of two links and a joint, with the given texts inside.
std::string robot(const std::string& in_link, const std::string& joint_type, const std::string& in_joint) {
  return "<robot name='r'>\n<link name='a'>" + in_link + "</link>\n<link name='b'>" + kSolid +
         "</link>\n<joint name='j' type='" + joint_type + "'><parent link='a'/><child link='b'/>\n" +
         in_joint + "</joint>\n</robot>";
}

const std::string kAxis = "<axis xyz='0 0 1'/>";

struct BadModel {
  std::string text;
  std::string message;
};

TEST(BadUrdf, EachFaultNamesLineAndElement) {
  const BadModel kBad[] = {
      {"", "m.urdf: not valid XML: the file is empty"},
      {"hello", "m.urdf:1: not valid XML: text stands outside of all elements"},
      {"<robot name='r'>\n<link", "m.urdf:2: not valid XML: an element is cut off or not well written"},
      {"<robot name='r'>\n<link name='a'></robot>",
       "m.urdf:2: not valid XML: an element is not closed, or by another one's name"},
      {"<html/>",
       "m.urdf:1: is neither URDF (<robot>) nor SDF (<sdf>) nor MJCF (<mujoco>): its root is <html>"},
      {"<?xml version='1.0'?>\n<!DOCTYPE r [<!ENTITY a 'ha'><!ENTITY b '&a;&a;'>]>\n<robot name='&b;'/>",
       "m.urdf:2: document types and entities (<!...>) are not supported"},
      {"<robot/>", "m.urdf:1: <robot> needs 'name'"},
      {"<robot name='r'/>", "m.urdf:1: has no link"},
      {"<robot name='r'>\n<link/></robot>", "m.urdf:2: <link> needs 'name'"},
      {"<robot name='r'>\n<link name='a'/>\n<link name='a'/></robot>",
       "m.urdf:3: link 'a': there is already one of this name (line 2)"},
      {"<robot name='r'><link name='a'/>\n<link name='b'/></robot>",
       "m.urdf:1: has more than one root link: 'a' and 'b'"},
      {robot("<inertial>\n<mass value='-1'/></inertial>", "fixed", ""),
       "m.urdf:3: link 'a': mass value must be at least 0, is '-1'"},
      {robot("<inertial>\n<mass value='nan'/></inertial>", "fixed", ""),
       "m.urdf:3: link 'a': mass value must be a finite number, is 'nan'"},
      {robot("<inertial><mass value='heavy'/></inertial>", "fixed", ""),
       "m.urdf:2: link 'a': mass value must be a number, is 'heavy'"},
      {robot("<inertial><mass/></inertial>", "fixed", ""), "m.urdf:2: link 'a': <mass> needs 'value'"},
      {robot("<inertial><origin xyz='0 inf 0'/></inertial>", "fixed", ""),
       "m.urdf:2: link 'a': origin xyz must be a finite number, is '0 inf 0'"},
      {robot("<collision><origin xyz='0 0'/></collision>", "fixed", ""),
       "m.urdf:2: link 'a': origin xyz must be 3 numbers, is '0 0'"},
      {robot("<collision><geometry><box size='1 -1 1'/></geometry></collision>", "fixed", ""),
       "m.urdf:2: link 'a': box size must be greater than 0, is '1 -1 1'"},
      {robot("<collision><geometry><cylinder radius='1'/></geometry></collision>", "fixed", ""),
       "m.urdf:2: link 'a': <cylinder> needs 'length'"},
      {robot("<collision><geometry><mesh filename='gone.stl'/></geometry></collision>", "fixed", ""),
       "m.urdf:2: link 'a': mesh 'gone.stl': no such file ('gone.stl')"},
      {robot("<collision><geometry><mesh filename='package://p/gone.stl'/></geometry></collision>", "fixed",
             ""),
       "m.urdf:2: link 'a': mesh 'package://p/gone.stl': no such file in the folders above the model; name "
       "its package's folder with --package NAME=PATH"},
      {robot("<collision><geometry><mesh filename='https://x.org/a.stl'/></geometry></collision>", "fixed",
             ""),
       "m.urdf:2: link 'a': mesh 'https://x.org/a.stl': addresses are not followed, name a file"},
      {robot("<collision name='c'><geometry><mesh filename='a.dae'/></geometry></collision>", "fixed", ""),
       "m.urdf:2: link 'a': mesh 'a.dae': no such file ('a.dae')"},
      {robot("<collision><geometry><mesh filename='a.stl' scale='1 1 0'/></geometry></collision>", "fixed",
             ""),
       "m.urdf:2: link 'a': mesh scale must not be zero, is '1 1 0'"},
      {robot("", "revolute", kAxis), "m.urdf:4: joint 'j': a revolute joint needs a <limit>"},
      {robot("", "prismatic", kAxis + "<limit lower='0' upper='inf' effort='1' velocity='1'/>"),
       "m.urdf:5: joint 'j': limit upper must be a finite number, is 'inf'"},
      {robot("", "continuous", "<axis xyz='0 0 0'/>"), "m.urdf:5: joint 'j': axis xyz must not be zero"},
      {robot("", "continuous", "<axis xyz='0 nan 0'/>"),
       "m.urdf:5: joint 'j': axis xyz must be a finite number, is '0 nan 0'"},
      {robot("", "continuous", kAxis + "<dynamics damping='-1'/>"),
       "m.urdf:5: joint 'j': dynamics damping must be at least 0, is '-1'"},
      {robot("", "planar", ""),
       "m.urdf:4: joint 'j': joints of type 'planar' are not simulated (revolute, continuous, prismatic, "
       "fixed, floating are)"},
      {"<robot name='r'><link name='hand'/><joint name='j' type='fixed'><parent link='hnad'/><child "
       "link='hand'/></joint></robot>",
       "m.urdf:1: joint 'j': parent names link 'hnad', which does not exist; did you mean 'hand'?"},
      {"<robot name='r'><link name='a'/><joint name='j' type='fixed'><parent link='a'/></joint></robot>",
       "m.urdf:1: joint 'j': needs a <child>"},
      {"<robot name='r'><link name='a'/><joint name='j' type='fixed'><parent link='a'/><child "
       "link='a'/></joint></robot>",
       "m.urdf:1: joint 'j': connects link 'a' with itself"},
      {robot("", "fixed", "</joint>\n<joint name='k' type='fixed'><parent link='a'/><child link='b'/>"),
       "m.urdf:6: joint 'k': link 'b' hangs on another joint already: a URDF is a tree"},
      {robot("", "fixed", "</joint><joint name='k' type='fixed'><parent link='b'/><child link='a'/>"),
       "m.urdf:1: the joints form a cycle: there is no root link"},
      {robot("", "fixed", "</joint><joint name='j' type='fixed'><parent link='b'/><child link='a'/>"),
       "m.urdf:5: joint 'j': there is already one of this name (line 4)"},
  };
  for (const BadModel& bad : kBad) EXPECT_EQ(urdf_error(bad.text), bad.message) << bad.text;
}

TEST(BadUrdf, DeepNestingAndEntitiesAreRefusedAtOnce) {
  std::string deep = "<robot name='r'>";
  for (int i = 0; i < 200'000; ++i) deep += "<a>";
  EXPECT_EQ(urdf_error(deep), "m.urdf:1: XML elements are nested too deeply");
  EXPECT_EQ(urdf_error(std::string("<robot\0>", 8)), "m.urdf: not valid XML: holds a zero byte");
}

TEST(BadUrdf, LinksAndElementsAreCounted) {
  std::string many = "<robot name='r'><link name='a'/>";
  for (int i = 0; i < 1000; ++i) {
    const std::string name = "l" + std::to_string(i);
    many += "<link name='" + name + "'/><joint name='" + name +
            "' type='fixed'><parent link='a'/><child link='" + name + "'/></joint>";
  }
  EXPECT_EQ(urdf_error(many + "</robot>"), "m.urdf: has 1001 links, at most 1000 are read");
  std::string large = "<robot name='r'><link name='a'>";
  for (int i = 0; i < 50'000; ++i) large += "<visual/>";
  EXPECT_EQ(urdf_error(large + "</link></robot>"), "m.urdf: has 50001 XML elements, at most 50000 are read");
}

TEST(BadSdf, EachFaultIsNamed) {
  const auto sdf = [](const std::string& inside) {
    return urdf_error("<sdf version='1.7'>\n" + inside + "</sdf>");
  };
  const auto model = [&](const std::string& inside) {
    return sdf("<model name='m'>\n" + inside + "</model>");
  };
  EXPECT_EQ(sdf(""), "m.urdf:1: has no <model>");
  EXPECT_EQ(sdf("<model name='a'/>\n<model name='b'/>"), "m.urdf:3: has more than one <model>");
  EXPECT_EQ(model("<include><uri>model://x</uri></include>"),
            "m.urdf:3: <include> 'model://x': no such model beside the file or in the folders above it; name "
            "its folder with --package NAME=PATH or in GZ_SIM_RESOURCE_PATH");
  EXPECT_EQ(model("<include><uri>https://fuel.gazebosim.org/1.0/a</uri></include>"),
            "m.urdf:3: <include> 'https://fuel.gazebosim.org/1.0/a': nothing is fetched from a network; "
            "download the model, and name its folder in the <uri>");
  EXPECT_EQ(model("<include/>"), "m.urdf:3: <include> needs a <uri>");
  EXPECT_EQ(model("<link name='a'><pose>0 0 nan 0 0 0</pose></link>"),
            "m.urdf:3: link 'a': pose must be a finite number, is '0 0 nan 0 0 0'");
  EXPECT_EQ(model("<link name='a'><inertial><mass>-1</mass></inertial></link>"),
            "m.urdf:3: link 'a': mass must be greater than 0, is '-1'");
  EXPECT_EQ(
      model("<link name='a'/><link name='b'/><joint name='j' "
            "type='telescope'><parent>a</parent><child>b</child></joint>"),
      "m.urdf:3: joint 'j': joints of type 'telescope' are not simulated (revolute, continuous, prismatic, "
      "fixed, ball, universal, revolute2 and screw are)");
  EXPECT_EQ(
      model(
          "<link name='a'/><link name='b'/><joint name='j' type='revolute'><parent>a</parent><child>b</child>"
          "<axis><xyz>0 0 0</xyz></axis></joint>"),
      "m.urdf:3: joint 'j': xyz must not be zero");
  EXPECT_EQ(urdf_error("<sdf version='x'><model name='m'><link name='a'/></model></sdf>"),
            "m.urdf:1: the version must be one of SDF 1, such as 1.9, is 'x'");
  EXPECT_EQ(sdf("<model name='m'/>"), "m.urdf:2: has no <link>");
}

}  // namespace
}  // namespace visum::scene

// Collada visuals through the real visum-mesh: good, broken, hostile and missing files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "protocol/config/read_file.h"
#include "server/scene/collada_reader.h"
#include "server/scene/robot_model.h"
#include "server/scene/scene.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

using test::TempFiles;
using testing::ElementsAre;
using testing::HasSubstr;

const std::filesystem::path kBadge =
    std::filesystem::path(VISUM_SOURCE_DIR) / "tests/scene/data/meshes/badge.dae";

std::string why_not(const std::filesystem::path& file) {
  try {
    read_collada(file);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

// A document with one mesh of these positions and triangle indices.
std::string document(const std::string& array, const std::string& indices) {
  return "<?xml version=\"1.0\"?><COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" "
         "version=\"1.4.1\"><asset><unit meter=\"1\"/></asset><library_geometries><geometry id=\"g\"><mesh>"
         "<source id=\"s\">" +
         array +
         "<technique_common><accessor source=\"#a\" count=\"3\" stride=\"3\"><param name=\"X\" "
         "type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor>"
         "</technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" source=\"#s\"/>"
         "</vertices><triangles count=\"1\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>" +
         indices +
         "</p></triangles></mesh></geometry></library_geometries><library_visual_scenes><visual_scene "
         "id=\"x\"><node><instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes>"
         "<scene><instance_visual_scene url=\"#x\"/></scene></COLLADA>";
}
const std::string kTriangle = "<float_array id=\"a\" count=\"9\">0 0 0 1 0 0 0 1 0</float_array>";

TEST(Collada, PartsComeByMaterialInMetresInTheFilesOwnAxes) {
  const ColladaMesh badge = read_collada(kBadge);
  ASSERT_EQ(badge.parts.size(), 2u);
  const ColladaPart& square = badge.parts[0];
  EXPECT_EQ(square.mesh.triangles.size(), 2u) << "of one polygon; the line is no surface";
  ASSERT_EQ(square.mesh.vertices.size(), 4u);
  EXPECT_TRUE(square.mesh.vertices[0].isApprox(Eigen::Vector3d::Zero()));
  EXPECT_TRUE(square.mesh.vertices[2].isApprox(Eigen::Vector3d(0.1, 0.2, 0), 1e-6)) << "centimetres";
  EXPECT_THAT(*square.color, ElementsAre(0.25, 0.5, 0.125, 1));
  EXPECT_TRUE(badge.parts[1].mesh.vertices[0].isApprox(Eigen::Vector3d(0, 0, 1), 1e-6)) << "a moved node";
  EXPECT_FALSE(badge.parts[1].color) << "it has a texture";
  EXPECT_TRUE(badge.textured);
}

TEST(Collada, IsConvertedOnce) {
  const TempFiles files;
  const AnswerCache cache(files.folder() / "cache");
  const auto file = files.folder() / "a.dae";
  std::filesystem::copy_file(kBadge, file);
  const ColladaProcess process{.program = VISUM_BIN_DIR "/visum-mesh", .cache = &cache};
  ColladaProcess none = process;
  none.deadline = std::chrono::milliseconds(0);  // whatever is asked of this one fails
  EXPECT_THROW(read_collada(file, none), std::runtime_error) << "a failure is no answer";
  const ColladaMesh first = read_collada(file, process);
  config::FilesNoted noted;
  const ColladaMesh kept = read_collada(file, none);
  ASSERT_EQ(kept.parts.size(), 2u);
  for (std::size_t part = 0; part < 2; ++part) {
    EXPECT_EQ(kept.parts[part].mesh.vertices, first.parts[part].mesh.vertices);
    EXPECT_EQ(kept.parts[part].mesh.triangles, first.parts[part].mesh.triangles);
    EXPECT_EQ(kept.parts[part].mesh.name, "a.dae");
    EXPECT_EQ(kept.parts[part].color, first.parts[part].color);
  }
  EXPECT_TRUE(kept.textured);
  EXPECT_EQ(noted.files.count(file.string()), 1u) << "as if it were converted";
  files.write("a.dae", document(kTriangle, "0 1 2"));
  EXPECT_THROW(read_collada(file, none), std::runtime_error) << "other content";
}

TEST(Collada, ManyFilesAreReadAtOnce) {
  const TempFiles files;
  std::vector<std::filesystem::path> list;
  for (int i = 0; i < 20; ++i) {
    const std::string end = std::to_string(i + 1);
    list.push_back(files.write(
        "m" + end + ".dae",
        document("<float_array id=\"a\" count=\"9\">0 0 0 " + end + " 0 0 0 1 0</float_array>", "0 1 2")));
  }
  files.write("m8.dae", "<COLLADA");
  list.push_back("/nowhere/a.dae");
  config::FilesNoted noted;
  const auto results = read_all_collada(list);
  ASSERT_EQ(results.size(), 21u);
  for (std::size_t i = 0; i < 20; ++i) {
    if (i == 7) continue;
    ASSERT_FALSE(results[i].fault) << i;
    EXPECT_EQ(results[i].mesh.parts.at(0).mesh.vertices[1].x(), static_cast<double>(i + 1));
    EXPECT_EQ(noted.files.count(list[i].string()), 1u);
  }
  for (const std::size_t bad : {7u, 20u}) {
    ASSERT_TRUE(results[bad].fault);
    EXPECT_THROW(std::rethrow_exception(results[bad].fault), std::runtime_error);
  }
  EXPECT_TRUE(read_all_collada({}).empty());
}

// Each of these readers waits until two have begun.
TEST(Collada, IsConvertedBySeveralReadersAtOnce) {
  if (std::thread::hardware_concurrency() < 2) GTEST_SKIP() << "there is one processor";
  const TempFiles files;
  const std::string begun = (files.folder() / "begun").string();
  std::filesystem::create_directory(begun);
  const auto reader = files.write("reader", "#!/bin/sh\n: > " + begun + "/$$\nuntil [ $(ls " + begun +
                                                " | wc -l) -ge 2 ]; do sleep 0.05; done\nexec " VISUM_BIN_DIR
                                                "/visum-mesh\n");
  std::filesystem::permissions(reader, std::filesystem::perms::owner_all);
  std::vector<std::filesystem::path> list;
  for (const char* name : {"a.dae", "b.dae"}) list.push_back(files.write(name, document(kTriangle, "0 1 2")));
  for (const auto& result : read_all_collada(list, {.program = reader.string()})) EXPECT_FALSE(result.fault);
}

TEST(Collada, AnAnswerNamesNoMoreCodeThanThereCanBe) {
  const std::string line = "code 0a /lib/a.so\n";
  std::string answer;
  for (std::size_t i = 0; i < AnswerCache::kMaxCode; ++i) answer += line;
  const std::string mesh = "part none 84\n" + std::string(80, ' ') + std::string(4, '\0') + "end\n";
  const auto why_not = [](const std::string& text) -> std::string {
    try {
      read_collada_answer(text, "a.dae");
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(why_not(answer + mesh), HasSubstr("holds no triangle"));
  EXPECT_EQ(why_not(answer + line + mesh), "its reader's answer is not a mesh");
  EXPECT_EQ(why_not("code 0a\n" + mesh), "its reader's answer is not a mesh");
}

TEST(Collada, TheSmallestDocumentIsRead) {
  const TempFiles files;
  const ColladaMesh mesh = read_collada(files.write("a.dae", document(kTriangle, "0 1 2")));
  ASSERT_EQ(mesh.parts.size(), 1u);
  EXPECT_EQ(mesh.parts[0].mesh.triangles.size(), 1u);
  EXPECT_FALSE(mesh.textured);
}

TEST(Collada, AMissingFileSaysSo) {
  EXPECT_EQ(why_not("/nowhere/a.dae"), "it cannot be opened: no such file");
}

TEST(Collada, BrokenFilesAreRefusedInTheReadersWords) {
  const TempFiles files;
  const std::string good = document(kTriangle, "0 1 2");
  EXPECT_EQ(why_not(files.write("empty.dae", "")), "it is empty");
  EXPECT_THAT(why_not(files.write("half.dae", good.substr(0, good.size() / 2))), HasSubstr("malformed XML"));
  EXPECT_NE(why_not(files.write("text.dae", "no XML at all")), "");
  EXPECT_NE(why_not(files.write("other.dae", "<html><body/></html>")), "");
  EXPECT_NE(why_not(files.write("nothing.dae", document(kTriangle, ""))), "");
}

struct Hostile {
  const char* name;
  std::string document;
};
class HostileCollada : public testing::TestWithParam<Hostile> {};

TEST_P(HostileCollada, HasAReasonAndNoMesh) {
  const TempFiles files;
  EXPECT_NE(why_not(files.write("hostile.dae", GetParam().document)), "");
}

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

const std::string kFrom =
    "<?xml version=\"1.0\"?><COLLADA version=\"1.4.1\"><library_visual_scenes><visual_scene id=\"x\">";
const std::string kTo =
    "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#x\"/></scene></COLLADA>";

INSTANTIATE_TEST_SUITE_P(
    Files, HostileCollada,
    testing::Values(
        Hostile{"DeepNesting", kFrom + repeated("<node>", 300'000) + repeated("</node>", 300'000) + kTo},
        Hostile{"ANodeThatHoldsItself", kFrom + "<node id=\"n\"><instance_node url=\"#n\"/></node>" + kTo},
        Hostile{"HugeCount",
                document("<float_array id=\"a\" count=\"4000000000\">0 0 0</float_array>", "0 1 2")},
        Hostile{"IndexBeyondTheVertices", document(kTriangle, "0 1 4000000")},
        Hostile{"NegativeIndex", document(kTriangle, "0 1 -7")},
        Hostile{"NotANumber",
                document("<float_array id=\"a\" count=\"9\">0 0 0 nan 0 0 0 inf 0</float_array>", "0 1 2")},
        Hostile{"EntitiesThatGrow",
                "<?xml version=\"1.0\"?><!DOCTYPE l [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;\">]>"
                "<COLLADA version=\"1.4.1\"><asset><title>&b;</title></asset></COLLADA>"}),
    [](const auto& info) { return info.param.name; });

// A link with these visuals.
std::string robot(const std::string& visuals) {
  return "<robot name='r'><link name='a'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' "
         "ixz='0' iyz='0'/></inertial>" +
         visuals + "</link></robot>";
}

class ColladaVisuals : public testing::Test {
 protected:
  ColladaVisuals() { std::filesystem::copy(kBadge, files_.folder() / "badge.dae"); }
  RobotModel read(const std::string& visuals) const {
    return read_robot_model(files_.folder() / "m.urdf", robot(visuals));
  }
  TempFiles files_;
};

TEST_F(ColladaVisuals, OneShapeForEachMaterial) {
  const RobotModel model = read(
      "<visual name='v'><origin xyz='0 0 5'/><geometry><mesh filename='badge.dae'/></geometry></visual>");
  const auto& shapes = model.links[0].shapes;
  ASSERT_EQ(shapes.size(), 2u);
  for (const RobotShape& shape : shapes) {
    EXPECT_FALSE(shape.collides);
    EXPECT_EQ(shape.X_LS.p, Eigen::Vector3d(0, 0, 5));
  }
  EXPECT_THAT(*shapes[0].color, ElementsAre(0.25, 0.5, 0.125, 1));
  EXPECT_EQ(shapes[1].mesh_part, 1u);
  EXPECT_THAT(model.losses, ElementsAre("visual 'v' of link 'a' is shown without the textures of its mesh"));
}

TEST_F(ColladaVisuals, OnlyFilesThatAreReadAreNoted) {
  for (const char* name : {"submesh.dae", "bitmask.dae", "elsewhere.dae"})
    std::filesystem::copy(kBadge, files_.folder() / name);
  const auto visual = [](const std::string& mesh) {
    return "<visual name='" + mesh + "'><geometry><mesh><uri>" + mesh + ".dae</uri>" +
           (mesh == "submesh" ? "<submesh><name>x</name></submesh>" : "") + "</mesh></geometry></visual>";
  };
  const std::string collision =
      "<collision name='c'><geometry><mesh><uri>bitmask.dae</uri></mesh></geometry><surface><contact>"
      "<collide_bitmask>0</collide_bitmask></contact></surface></collision>";
  config::FilesNoted noted;
  read_robot_model(files_.folder() / "m.sdf", "<sdf version='1.7'><model name='m'><link name='a'>" +
                                                  visual("badge") + visual("submesh") + collision +
                                                  "</link></model></sdf>");
  read("<visual name='v'><geometry><box size='1 1 1'/><mesh filename='elsewhere.dae'/></geometry></visual>");
  ASSERT_EQ(noted.files.size(), 1u);
  EXPECT_EQ(noted.files.begin()->first, (files_.folder() / "badge.dae").string());
}

TEST_F(ColladaVisuals, TheModelsOwnMaterialColoursAll) {
  const RobotModel model = read(
      "<visual name='v'><geometry><mesh filename='badge.dae'/></geometry><material name='m'><color rgba='0 1 "
      "1 "
      "1'/></material></visual>");
  for (const RobotShape& shape : model.links[0].shapes) EXPECT_THAT(*shape.color, ElementsAre(0, 1, 1, 1));
}

TEST_F(ColladaVisuals, WhatCannotBeReadIsALossThatSaysWhy) {
  files_.write("broken.dae", "<COLLADA");
  const RobotModel model = read(
      "<visual name='v'><geometry><mesh filename='broken.dae'/></geometry></visual>"
      "<visual name='w'><geometry><mesh filename='broken.dae'/></geometry></visual>");
  EXPECT_TRUE(model.links[0].shapes.empty());
  ASSERT_EQ(model.losses.size(), 2u);
  EXPECT_THAT(model.losses[1].text, HasSubstr("visual 'w' of link 'a' is not shown: it is the mesh '"));
  EXPECT_THAT(model.losses[1].text, HasSubstr("broken.dae': "));
}

TEST_F(ColladaVisuals, AMissingFileIsALossAndForACollisionAnError) {
  const std::string geometry = "<geometry><mesh filename='gone.dae'/></geometry>";
  const RobotModel model = read("<visual name='v'>" + geometry + "</visual>");
  ASSERT_EQ(model.losses.size(), 1u);
  EXPECT_EQ(model.losses[0].text,
            "visual 'v' of link 'a' is not shown: it is the mesh 'gone.dae': no such file ('" +
                (files_.folder() / "gone.dae").string() + "')");
  EXPECT_EQ(files_.error_of([&] { read("<collision>" + geometry + "</collision>"); }),
            "m.urdf:1: link 'a': mesh 'gone.dae': no such file ('gone.dae')");
}

TEST_F(ColladaVisuals, AreInTheWorldOnceForEachScale) {
  const auto one = [](const char* name) {
    return std::string("<visual name='") + name +
           "'><geometry><mesh filename='badge.dae'/></geometry></visual>";
  };
  files_.write("m.urdf",
               robot(one("v") + one("w") +
                     "<visual name='x'><geometry><mesh filename='badge.dae' scale='2 2 2'/></geometry>"
                     "</visual>"));
  const auto file = files_.write("s.yaml", "visum: 1\nname: s\nmodels: [{name: r, file: m.urdf}]\n");
  const Scene scene = load_scene(file);
  EXPECT_EQ(scene.world.shapes.size(), 6u);
  ASSERT_EQ(scene.world.meshes.size(), 4u);
  EXPECT_EQ(scene.world.shapes[0].mesh, scene.world.shapes[2].mesh);
  EXPECT_TRUE(scene.world.meshes[2].vertices[2].isApprox(Eigen::Vector3d(0.2, 0.4, 0), 1e-6));
}

TEST(ColladaAnswer, ThatIsNoMeshIsRefused) {
  const auto refused = [](const std::string& answer) {
    try {
      read_collada_answer(answer, "a.dae");
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const char* answer : {"", "end\n", "part none 5\nab", "part none\nend\n", "part 2 0 0 1 4\nabcd",
                             "part 0 0 0 4\nabcd", "part none 4 5\nabcd", "other\nend\n", "textured\n"})
    EXPECT_EQ(refused(answer), "its reader's answer is not a mesh") << answer;
}

}  // namespace
}  // namespace visum::scene

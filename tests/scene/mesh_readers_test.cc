#include "server/scene/mesh_readers.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "server/scene/inertia.h"
#include "tests/scene/data_folder.h"
#include "tests/support/temp_files.h"

namespace visum::scene {
namespace {

const config::Place kAsker{"asker.yaml", 3, "shapes[0]"};

using Corners = std::array<std::array<float, 3>, 3>;

std::string binary_stl(const std::vector<Corners>& triangles, std::uint32_t count) {
  std::string bytes(80, ' ');
  bytes.replace(0, 5, "solid");  // many programs begin binary files with this word
  const auto append = [&](const void* from, std::size_t size) {
    bytes.append(static_cast<const char*>(from), size);
  };
  append(&count, 4);
  for (const Corners& corners : triangles) {
    bytes.append(12, '\0');
    append(&corners, sizeof corners);
    bytes.append(2, '\0');
  }
  return bytes;
}

template <typename Call>
std::string error_of(const Call& call) {
  return test::TempFiles().error_of(call);
}

TEST(MeshReaders, TextStlAndObjOfOneSolidAgree) {
  world::Shape shape;
  shape.kind = world::ShapeKind::kMesh;
  const world::TriangleMesh stl = read_mesh(kData / "meshes/wedge.stl", kAsker);
  const world::TriangleMesh obj = read_mesh(kData / "wedge.obj", kAsker);
  for (const auto* mesh : {&stl, &obj}) {
    EXPECT_EQ(mesh->vertices.size(), 6u);
    EXPECT_EQ(mesh->triangles.size(), 8u);
    EXPECT_EQ(solid_fault(*mesh), "");
    EXPECT_NEAR(solid_of(shape, mesh).mass_kg, 0.5, 1e-15);
    EXPECT_TRUE(solid_of(shape, mesh).com.isApprox(Eigen::Vector3d(1.0 / 3, 0.5, 1.0 / 3)));
  }
}

TEST(MeshReaders, BinaryStlJoinsEqualCorners) {
  const Corners a{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, b{{{1, 0, 0}, {1, 1, 0}, {-0.0f, 1, 0}}};
  const world::TriangleMesh mesh = read_stl(binary_stl({a, b}, 2), "m.stl");
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.triangles[1], (std::array<std::uint32_t, 3>{1, 3, 2}));
}

TEST(MeshReaders, TrianglesWithTwoEqualCornersAreLeftOut) {
  const Corners flat{{{0, 0, 0}, {0, 0, 0}, {0, 1, 0}}}, good{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
  EXPECT_EQ(read_stl(binary_stl({flat, good}, 2), "m.stl").triangles.size(), 1u);
  EXPECT_EQ(error_of([&] { read_stl(binary_stl({flat}, 1), "m.stl"); }), "m.stl: holds no triangle");
}

TEST(MeshReaders, StlFaultsAreNamed) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const Corners good{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, bad{{{0, 0, 0}, {nan, 0, 0}, {0, 1, 0}}};
  const auto stl = [](const std::string& bytes) { return error_of([&] { read_stl(bytes, "m.stl"); }); };
  EXPECT_EQ(stl(""), "m.stl: is too short for an STL file: 0 bytes");
  EXPECT_EQ(stl(binary_stl({good}, 4'000'000'000)),
            "m.stl: its count of 4000000000 triangles needs 200000000084 bytes, the file has 134");
  EXPECT_EQ(stl(binary_stl({good, good}, 2).substr(0, 150)),
            "m.stl: its count of 2 triangles needs 184 bytes, the file has 150");
  EXPECT_EQ(stl(binary_stl({}, 0)), "m.stl: holds no triangle");
  EXPECT_EQ(stl(binary_stl({good, bad}, 2)), "m.stl: triangle 1 has a vertex that is not finite");
  EXPECT_EQ(stl("solid x\nendsolid x\n"), "m.stl: holds no triangle");
  EXPECT_EQ(stl("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 abc\n"),
            "m.stl:4: expected 'a number', there is 'abc'");
  EXPECT_EQ(stl("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 inf\nvertex 1 0 0\nvertex 0 1 0\n"),
            "m.stl:6: triangle 0 has a vertex that is not finite");
  EXPECT_EQ(stl("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0"),
            "m.stl:4: expected 'a number', the file ends");
  EXPECT_EQ(stl("solid x\nfase\n"), "m.stl:2: expected 'facet', there is 'fase'");
}

TEST(MeshReaders, ObjFaultsAreNamed) {
  const auto obj = [](const std::string& text) { return error_of([&] { read_obj(text, "m.obj"); }); };
  const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_EQ(obj(corners + "f 1 2 3\n"), "no error");
  EXPECT_EQ(obj(corners + "f -3 -2 -1"), "no error");
  EXPECT_EQ(obj(""), "m.obj: holds no triangle");
  EXPECT_EQ(obj(corners + "f 1 2 4\n"), "m.obj:4: face names vertex 4, there are 3 so far");
  EXPECT_EQ(obj(corners + "f 1 2 0\n"), "m.obj:4: face names vertex 0, there are 3 so far");
  EXPECT_EQ(obj(corners + "f 1 2 -4\n"), "m.obj:4: face names vertex -4, there are 3 so far");
  EXPECT_EQ(obj(corners + "f 1 2 99999999999999999999\n"),
            "m.obj:4: '99999999999999999999' is not a valid corner of a face");
  EXPECT_EQ(obj(corners + "f 1 2\n"), "m.obj:4: a face needs three corners, has 2");
  EXPECT_EQ(obj("v 0 zero 0\n"), "m.obj:1: a vertex needs three numbers");
  EXPECT_EQ(obj("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
            "m.obj:4: triangle 0 has a vertex that is not finite");
  EXPECT_EQ(obj("hello\n"), "m.obj:1: 'hello' is not a keyword of an OBJ file");
}

TEST(MeshReaders, FilesThatCannotBeReadAreReportedToWhoAsked) {
  const test::TempFiles files;
  const auto read = [&](const std::filesystem::path& path) {
    return files.error_of([&] { read_mesh(path, kAsker); });
  };
  EXPECT_EQ(read(files.folder() / "none.stl"), "asker.yaml:3: shapes[0]: 'none.stl': no such file");
  EXPECT_EQ(read(files.write("a.dae", "x")),
            "asker.yaml:3: shapes[0]: 'a.dae': is not a mesh that can be read (.stl or .obj)");
  const auto huge = files.write("huge.stl", "x");
  std::filesystem::resize_file(huge, kMaxMeshBytes + 1);
  EXPECT_EQ(read(huge),
            "asker.yaml:3: shapes[0]: 'huge.stl': has 134217729 bytes, at most 134217728 are read");
}

TEST(MeshReaders, TheNumberOfTrianglesIsCapped) {
  MeshBuilder builder("m.obj");
  const std::array<Eigen::Vector3d, 3> corners{Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0),
                                               Eigen::Vector3d(0, 1, 0)};
  for (std::size_t i = 0; i < world::kMaxTriangles; ++i) builder.add(corners, 1);
  EXPECT_EQ(error_of([&] { builder.add(corners, 7); }), "m.obj:7: more than 2000000 triangles");
}

}  // namespace
}  // namespace visum::scene

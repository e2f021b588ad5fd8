// Rays through whole worlds: the nearest of many shapes, meshes, moving bodies, invisible shapes.
#include "server/sensing/ray_world.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "server/sensing/solid.h"
#include "tests/sensing/world_bench.h"

namespace visum::sensing {
namespace {

using Eigen::Vector3d;

struct Place {
  explicit Place(const std::string& yaml)
      : scene(test::scene_of(yaml)), state(world::initial_state(scene.world)), rays(scene.world) {
    rays.place(state);
  }
  Hit cast(const Vector3d& p, const Vector3d& d, const char* blind_to = "") const {
    return rays.cast({p, d.normalized(), 100.0, scene.world.find_body(blind_to)});
  }
  std::string name_of(const Hit& hit) const {
    if (!hit.shape.valid()) return "nothing";
    return scene.world.bodies[scene.world.shapes[hit.shape.index()].body.index()].name;
  }

  scene::Scene scene;
  world::WorldState state;
  RayWorld rays;
};

// A cube of 2 m as a mesh, standing on z = 0.
const std::string kCube = R"(v -1 -1 0
v 1 -1 0
v 1 1 0
v -1 1 0
v -1 -1 2
v 1 -1 2
v 1 1 2
v -1 1 2
f 1 3 2
f 1 4 3
f 5 6 7
f 5 7 8
f 1 2 6
f 1 6 5
f 2 3 7
f 2 7 6
f 3 4 8
f 3 8 7
f 4 1 5
f 4 5 8
)";

struct MeshPlace {
  MeshPlace()
      : scene([this] {
          files.write("cube.obj", kCube);
          return scene::load_scene(files.write("world.yaml", R"(visum: 1
bodies:
  - {name: cube, fixed: true, pose: {xyz: [3, 0, 0], rpy: [0, 0, 0.5]}, shapes: [{mesh: cube.obj}]}
  - {name: far, fixed: true, pose: {xyz: [9, 0, 0]}, shapes: [{mesh: cube.obj}]}
)"));
        }()),
        rays(scene.world) {
    rays.place(world::initial_state(scene.world));
  }
  visum::test::TempFiles files;
  scene::Scene scene;
  RayWorld rays;
};

TEST(RayWorld, FindsTheNearestOfAllKinds) {
  const Place place(R"(bodies:
  - {name: ball, fixed: true, pose: {xyz: [2, 0, 1]}, shapes: [{sphere: 0.5}]}
  - {name: box, fixed: true, pose: {xyz: [5, 0, 1]}, shapes: [{box: [1, 1, 1]}]}
  - {name: floor, fixed: true, shapes: [{plane: true}]}
)");
  EXPECT_EQ(place.name_of(place.cast({0, 0, 1}, {1, 0, 0})), "ball");
  EXPECT_NEAR(place.cast({0, 0, 1}, {1, 0, 0}).distance_m, 1.5, 1e-13);
  EXPECT_EQ(place.name_of(place.cast({3, 0, 1}, {1, 0, 0})), "box");
  EXPECT_EQ(place.name_of(place.cast({0, 0, 1}, {0, 0, -1})), "floor");
  EXPECT_EQ(place.name_of(place.cast({0, 0, 1}, {0, 0, 1})), "nothing");
  EXPECT_EQ(place.name_of(place.cast({0, 0, 1}, {1, 0, 0}, "ball")), "box") << "blind to the ball";
}

TEST(RayWorld, ARayEndsAtItsLength) {
  const Place place("bodies: [{name: ball, fixed: true, shapes: [{sphere: 1}]}]\n");
  const auto seen = [&](double length) {
    return place.rays.cast({{-5, 0, 0}, {1, 0, 0}, length, {}}).shape.valid();
  };
  EXPECT_FALSE(seen(3.999));
  EXPECT_TRUE(seen(4.001));
  EXPECT_FALSE(place.rays.blocked({{-5, 0, 0}, {1, 0, 0}, 3.999, {}}));
  EXPECT_TRUE(place.rays.blocked({{-5, 0, 0}, {1, 0, 0}, 4.001, {}}));
  EXPECT_FALSE(place.rays.blocked({{-5, 0, 0}, {1, 0, 0}, 4.001, {0}})) << "blind to it";
}

TEST(RayWorld, SeesTheInsideOfWhatItStandsIn) {
  const Place place("bodies: [{name: room, fixed: true, shapes: [{box: [4, 6, 3]}]}]\n");
  const Hit hit = place.cast({0, 0, 0}, {0, 1, 0});
  EXPECT_NEAR(hit.distance_m, 3.0, 1e-13);
  EXPECT_NEAR((hit.normal_W + Vector3d::UnitY()).norm(), 0.0, 1e-13) << "against the ray";
}

// A wall of the cube, turned by 0.5 rad about z, seen along x from 3 m before its middle: 3 - 1/cos 0.5.
TEST(RayWorld, AMeshIsWhereItsTrianglesAreInDoublePrecision) {
  const MeshPlace place;
  const Hit hit = place.rays.cast({{0, 0, 1.1}, {1, 0, 0}, 100.0, {}});
  EXPECT_NEAR(hit.distance_m, 3.0 - 1.0 / std::cos(0.5), 1e-12);
  EXPECT_NEAR((hit.normal_W + Vector3d(std::cos(0.5), std::sin(0.5), 0)).norm(), 0.0, 1e-12);
  const Hit behind = place.rays.cast({{0, 0, 1.1}, {1, 0, 0}, 100.0, {0}});
  EXPECT_NEAR(behind.distance_m, 8.0, 1e-12) << "blind to the first";
  EXPECT_TRUE(place.rays.blocked({{0, 0, 1.1}, {1, 0, 0}, 3.0, {}}));
  EXPECT_FALSE(place.rays.blocked({{0, 0, 1.1}, {1, 0, 0}, 3.0, {0}}));
}

TEST(RayWorld, NoRaySlipsThroughTheSeamsOfAMesh) {
  const MeshPlace place;
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (int i = 0; i < 20'000; ++i) {
    const Vector3d d = Vector3d(u(generator), u(generator), u(generator)).normalized();
    ASSERT_TRUE(place.rays.cast({{3, 0, 1}, d, 100.0, {}}).shape.valid()) << d.transpose();
  }
  // Along the diagonals, where triangles meet.
  for (const double angle : {0.5 + M_PI / 4, 0.5, 0.5 + M_PI / 2})
    EXPECT_TRUE(place.rays.cast({{3, 0, 1}, {std::cos(angle), std::sin(angle), 0}, 100.0, {}}).shape.valid());
}

TEST(RayWorld, FollowsWhatMoves) {
  Place place("bodies: [{name: ball, mass: 1, pose: {xyz: [2, 0, 0]}, shapes: [{sphere: 0.5}]}]\n");
  EXPECT_NEAR(place.cast({0, 0, 0}, {1, 0, 0}).distance_m, 1.5, 1e-13);
  place.state.bodies[0].p_WC.x() = 7;
  place.rays.place(place.state);
  EXPECT_NEAR(place.cast({0, 0, 0}, {1, 0, 0}).distance_m, 6.5, 1e-13);
}

TEST(RayWorld, DoesNotSeeWhatIsTransparent) {
  const Place place(R"(bodies:
  - {name: glass, fixed: true, pose: {xyz: [2, 0, 0]}, color: [1, 1, 1, 0], shapes: [{sphere: 0.5}]}
  - {name: wall, fixed: true, pose: {xyz: [4, 0, 0]}, shapes: [{box: [1, 1, 1], collides: false}]}
)");
  EXPECT_EQ(place.name_of(place.cast({0, 0, 0}, {1, 0, 0})), "wall");
}

TEST(RayWorld, AnEmptyWorldHasNothingInIt) {
  const Place place("name: empty\n");
  EXPECT_FALSE(place.cast({0, 0, 0}, {1, 0, 0}).shape.valid());
  EXPECT_FALSE(place.rays.blocked({{0, 0, 0}, {1, 0, 0}, 10.0, {}}));
}

// A heap of all kinds: each ray must find what asking each solid by itself finds.
TEST(RayWorld, AgreesWithAskingEachShapeByItself) {
  std::string yaml = "bodies:\n";
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  const char* shapes[] = {"{sphere: 0.3}", "{box: [0.4, 0.5, 0.6]}", "{cylinder: {radius: 0.3, length: 0.7}}",
                          "{capsule: {radius: 0.2, length: 0.4}}"};
  for (int i = 0; i < 60; ++i)
    yaml += "  - {name: b" + std::to_string(i) + ", fixed: true, pose: {xyz: [" +
            std::to_string(4 * u(generator)) + "," + std::to_string(4 * u(generator)) + "," +
            std::to_string(4 * u(generator)) + "], rpy: [" + std::to_string(u(generator)) + "," +
            std::to_string(u(generator)) + ",0]}, shapes: [" + shapes[i % 4] + "]}\n";
  const Place place(yaml);
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vector3d p(5 * u(generator), 5 * u(generator), 5 * u(generator));
    const Vector3d d = Vector3d(u(generator), u(generator), u(generator)).normalized();
    double nearest = 100.0;
    for (const auto& shape : place.scene.world.shapes) {
      const world::Pose X_WS = place.scene.world.bodies[shape.body.index()].X_WB * shape.X_BS;
      const auto to_S = X_WS.q.conjugate();
      const Passage passage =
          pass_through(make_solid(place.scene.world, shape), to_S * (p - X_WS.p), to_S * d);
      if (passage.in > passage.out) continue;
      const double t = passage.in > 0 ? passage.in : passage.out;
      if (t > 0) nearest = std::min(nearest, t);
    }
    const Hit hit = place.cast(p, d);
    ASSERT_EQ(hit.shape.valid(), nearest < 100.0) << i;
    ASSERT_EQ(place.rays.blocked({p, d, 100.0, {}}), nearest < 100.0) << i;
    if (!hit.shape.valid()) continue;
    ++hits;
    ASSERT_NEAR(hit.distance_m, nearest, 1e-12) << i;
  }
  EXPECT_GT(hits, 400);
}

}  // namespace
}  // namespace visum::sensing

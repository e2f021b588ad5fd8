// Cameras from the scene to the blackboard: projection, depth, light, noise, time.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

#include "hwparts/sensors/camera.h"
#include "tests/sensing/world_bench.h"

namespace visum::sensing {
namespace {

using Eigen::Vector3d;
using test::WorldBench;

struct Image {
  sensors::ImageHeader header;
  std::vector<std::byte> pixels;

  std::size_t index(int column, int row) const {
    return static_cast<std::size_t>(row) * header.width + static_cast<std::size_t>(column);
  }
  template <typename T>
  T at(int column, int row) const {
    T value;
    std::memcpy(&value, pixels.data() + index(column, row) * sizeof(T), sizeof(T));
    return value;
  }
  double red(int column, int row) const {
    return std::to_integer<int>(pixels[3 * index(column, row)]) / 255.0;
  }
};

Image image_of(const WorldBench& bench, const std::string& camera) {
  const auto bytes = bench.part(camera).part->read_blackboard(0);
  Image image;
  std::memcpy(&image.header, bytes.data(), sizeof image.header);
  image.pixels.assign(bytes.begin() + sizeof image.header, bytes.end());
  return image;
}

std::string camera(const std::string& keys) {
  return "  - {name: eye, kind: camera, size: [160, 120], fov_deg: 70, " + keys + "}\n";
}
sensors::Lens lens(double k1 = 0.0, double k2 = 0.0) {
  return {160, 120, 70 * M_PI / 180, k1, k2};
}

const std::string kLockstep = "clock: lockstep\n";

// Balls at known places: the middle of each one's pixels is where the pinhole puts its centre. The camera
// stands apart and is turned.
void expect_projection(const std::string& distortion, const sensors::Lens& lens) {
  const Vector3d centres[] = {{3, 0, 0}, {4, 1.5, 0.5}, {3, -1.2, -0.8}, {5, -2, 1.5}, {2.5, 0.7, -0.6}};
  const Eigen::Quaterniond q(Eigen::AngleAxisd(0.3, Vector3d::UnitZ()));
  const Vector3d p(0.5, -0.2, 1.0);
  std::string yaml = kLockstep + "bodies:\n";
  for (const Vector3d& c : centres) {
    const Vector3d at = p + q * c;
    yaml += "  - {name: b" + std::to_string(&c - centres) + ", fixed: true, pose: {xyz: [" +
            std::to_string(at.x()) + "," + std::to_string(at.y()) + "," + std::to_string(at.z()) +
            "]}, shapes: [{sphere: 0.08}]}\n";
  }
  WorldBench bench(yaml + "sensors:\n" +
                   camera("shows: segmentation, pose: {xyz: [0.5, -0.2, 1], rpy: [0, 0, 0.3]}" + distortion));
  bench.run(1);
  const Image image = image_of(bench, "eye");
  for (std::size_t ball = 0; ball < std::size(centres); ++ball) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    int count = 0;
    for (int row = 0; row < 120; ++row)
      for (int column = 0; column < 160; ++column)
        if (image.at<std::uint16_t>(column, row) == ball + 1) {
          sum += Eigen::Vector2d(column + 0.5, row + 0.5);
          ++count;
        }
    ASSERT_GT(count, 5) << ball;
    const auto expected = sensors::pixel_of(lens, {centres[ball].x(), centres[ball].y(), centres[ball].z()});
    EXPECT_NEAR(sum.x() / count, expected[0], 0.25) << ball;
    EXPECT_NEAR(sum.y() / count, expected[1], 0.25) << ball;
  }
  EXPECT_EQ(image.at<std::uint16_t>(0, 0), 0) << "nothing";
}

TEST(Camera, ProjectsAsAPinholeDoes) {
  expect_projection("", lens());
}

TEST(Camera, ProjectsAsItsLensDoes) {
  expect_projection(", distortion: [-0.15, 0.02]", lens(-0.15, 0.02));
}

// A wall 3 m ahead whose normal is turned by 0.4 rad: depth along the axis, pixel by pixel.
TEST(Camera, MeasuresDepthAlongItsAxis) {
  WorldBench bench(kLockstep + R"(
bodies: [{name: wall, fixed: true, pose: {xyz: [3, 0, 0], rpy: [0, 0, 0.4]}, shapes: [{box: [0.2, 90, 90]}]}]
sensors:
)" + camera("shows: depth, far: 50"));
  bench.run(1);
  const Image image = image_of(bench, "eye");
  const Vector3d normal(std::cos(0.4), std::sin(0.4), 0);
  for (int row = 0; row < 120; row += 7)
    for (int column = 0; column < 160; column += 7) {
      const auto d = sensors::direction_of(lens(), column + 0.5, row + 0.5);
      const double depth = (3 * std::cos(0.4) - 0.1) / normal.dot(Vector3d(d[0], d[1], d[2]));
      ASSERT_NEAR(image.at<float>(column, row), std::min(depth, 50.0), 1e-6 * depth);
    }
}

// Looking down on a white floor: a lamp from above at 30° lights it with cos 30°, not below the box.
TEST(Camera, LightFallsAndShadowsToo) {
  WorldBench bench(kLockstep + R"(
bodies:
  - {name: floor, fixed: true, color: [1, 1, 1], shapes: [{plane: true}]}
  - {name: box, fixed: true, pose: {xyz: [0, 0, 0.5]}, color: [0.5, 0.5, 0.5], shapes: [{box: [0.4, 0.4, 0.4]}]}
lights:
  - {kind: ambient, intensity: 0.2}
  - {kind: directional, direction: [0, 0.5, -0.8660254037844386], intensity: 0.6, shadows: true}
sensors:
)" + camera("pose: {xyz: [0, 0, 4], rpy: [0, 1.5707963267948966, 0]}"));
  bench.run(1);
  const Image image = image_of(bench, "eye");
  // Seen from above, columns go to -y and rows to -x; a metre on the floor is f/4 pixels.
  const double f = 80 / std::tan(35 * M_PI / 180);
  const auto red_at = [&](double x, double y, double z) {
    return image.red(static_cast<int>(80 - y * f / (4 - z)), static_cast<int>(60 - x * f / (4 - z)));
  };
  const double lit = 0.2 + 0.6 * std::cos(M_PI / 6);
  EXPECT_NEAR(red_at(0.8, -1, 0), lit, 1.0 / 255);
  EXPECT_NEAR(red_at(0, 0, 0.7), 0.5 * lit, 1.0 / 255) << "the box's top";
  // The shadow reaches tan 30° times the height of its edges beside the box: from 0.2 + 0.17 to 0.2 + 0.4 m.
  EXPECT_NEAR(red_at(0, 0.45, 0), 0.2, 1.0 / 255) << "in its shadow";
  EXPECT_NEAR(red_at(0, 0.75, 0), lit, 1.0 / 255) << "beyond it";
}

TEST(Camera, NoiseHasItsDeviationAndIsNewInEachPicture) {
  WorldBench bench(kLockstep + R"(
bodies: [{name: wall, fixed: true, pose: {xyz: [3, 0, 0]}, color: [0.5, 0.5, 0.5], shapes: [{box: [0.2, 90, 90]}]}]
lights: [{kind: ambient}]
sensors:
)" + camera("noise: 0.05, exposure: 1.2"));
  bench.run(1);
  const Image first = image_of(bench, "eye");
  double sum = 0, squares = 0;
  for (const std::byte value : first.pixels) {
    const double x = std::to_integer<int>(value) / 255.0;
    sum += x;
    squares += x * x;
  }
  const double count = static_cast<double>(first.pixels.size()), mean = sum / count;
  EXPECT_NEAR(mean, 0.6, 1e-3);
  EXPECT_NEAR(std::sqrt(squares / count - mean * mean), 0.05, 1e-3);
  bench.run(1);
  EXPECT_NE(image_of(bench, "eye").pixels, first.pixels);
}

const std::string kFalling = R"(
bodies:
  - {name: ball, mass: 1, pose: {xyz: [3, 0, 0.5]}, shapes: [{sphere: 0.3}]}
sensors:
)" + camera("rate_hz: 50, latency_ms: 30, noise: 0.02");

TEST(Camera, ShowsThePastByItsLatencyAndNothingBefore) {
  WorldBench bench(kLockstep + kFalling);
  EXPECT_EQ(image_of(bench, "eye").header.taken_ns, -1);
  bench.run(49);
  EXPECT_EQ(image_of(bench, "eye").header.taken_ns, -1);
  bench.run(1);
  EXPECT_EQ(image_of(bench, "eye").header.taken_ns, 20'000'000);
  bench.run(60);
  EXPECT_EQ(image_of(bench, "eye").header.taken_ns, 80'000'000);
  EXPECT_EQ(bench.port("eye", "Changed"), 4.0);
}

// Pictures are shown at 50, 70, 90, ... ms.
TEST(Camera, ASilentOneKeepsItsPictureThroughARestoreAndShowsTheNewestInTheEnd) {
  WorldBench bench(kLockstep + kFalling);
  bench.run(60);
  const auto before = image_of(bench, "eye").pixels;
  ASSERT_TRUE(bench.simulation.inject({0, {hwparts::FaultKind::kPartSilent, {}}, 100}).done());
  bench.run(40);
  EXPECT_EQ(image_of(bench, "eye").pixels, before);
  const auto snapshot = bench.simulation.take_snapshot();
  for (int i = 0; i < 2; ++i) {
    bench.run(1);
    EXPECT_EQ(image_of(bench, "eye").header.taken_ns, 60'000'000);
    EXPECT_EQ(bench.port("eye", "Changed"), 3.0);
    ASSERT_TRUE(bench.simulation.restore_snapshot(snapshot).done());
    EXPECT_EQ(image_of(bench, "eye").header.taken_ns, 20'000'000);
    EXPECT_EQ(image_of(bench, "eye").pixels, before);
  }
}

TEST(Camera, PicturesAreTheSameInEveryRunLookedAtOrNotAndAfterARestore) {
  WorldBench looked(kLockstep + kFalling), once(kLockstep + kFalling);
  for (int i = 0; i < 137; ++i) {
    looked.run(1);
    if (i % 40 == 0) image_of(looked, "eye");
  }
  once.run(137);
  const Image image = image_of(looked, "eye");
  EXPECT_EQ(image_of(once, "eye").pixels, image.pixels);
  EXPECT_EQ(looked.simulation.state_hash(), once.simulation.state_hash());
  const auto snapshot = once.simulation.take_snapshot();
  once.run(100);
  const Image later = image_of(once, "eye");
  EXPECT_NE(later.pixels, image.pixels);
  ASSERT_TRUE(once.simulation.restore_snapshot(snapshot).done());
  EXPECT_EQ(image_of(once, "eye").pixels, image.pixels);
  once.run(100);
  EXPECT_EQ(image_of(once, "eye").pixels, later.pixels) << "with those that were on their way";
}

TEST(Camera, RidesOnItsBodyAndDoesNotSeeItAndBodiesMayCome) {
  WorldBench bench(kLockstep + R"(
gravity: [0, 0, 0]
bodies: [{name: cart, mass: 1, shapes: [{box: [1, 1, 1]}]}]
sensors:
)" + camera("body: cart, shows: segmentation"));
  bench.run(1);
  EXPECT_EQ(image_of(bench, "eye").at<std::uint16_t>(80, 60), 0);
  EXPECT_TRUE(bench.simulation
                  .add_body("{name: wall, fixed: true, pose: {xyz: [3, 0, 0]}, shapes: [{box: [0.2, 1, 1]}]}")
                  .done());
  bench.run(1);
  EXPECT_EQ(image_of(bench, "eye").at<std::uint16_t>(80, 60), 2);
}

TEST(Camera, AllOfASceneTogetherHaveALimitOfPixels) {
  const visum::test::TempFiles files;
  const auto file = files.write("s.yaml", R"(visum: 1
sensors:
  - {name: "eye_${i}", repeat: {i: 4}, kind: camera, size: [4096, 1024], fov_deg: 60}
  - {name: last, kind: camera, size: [1, 1], fov_deg: 60}
)");
  EXPECT_EQ(files.error_of([&] { cycle::Simulation simulation(scene::load_scene(file)); }),
            "s.yaml:4: sensors[1].size: the cameras have more than 16777216 pixels together");
}

// In real time pictures are made beside the ticks, which go on meanwhile; the newest comes in the end.
TEST(Camera, InRealTimeNoTickWaitsForAPicture) {
  WorldBench bench("clock: realtime" + kFalling);
  bench.run(50);
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (image_of(bench, "eye").header.taken_ns < 0 && std::chrono::steady_clock::now() < give_up)
    std::this_thread::yield();
  EXPECT_EQ(image_of(bench, "eye").header.taken_ns, 20'000'000);
  EXPECT_EQ(bench.port("eye", "Changed"), 1.0);
}

}  // namespace
}  // namespace visum::sensing

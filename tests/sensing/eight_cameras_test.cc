// Eight calibrated cameras at once: models/scenes/eight_cameras.yaml, each picture is compared with the
// projection of bodies whose places are known.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "hwparts/sensors/camera.h"
#include "server/cycle/simulation.h"

namespace visum::sensing {
namespace {

constexpr int kWidth = 320, kHeight = 240;

// The middle of the ball's pixels; only the ball is red.
Eigen::Vector2d middle_of_ball(std::span<const std::byte> image) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (int row = 0; row < kHeight; ++row)
    for (int column = 0; column < kWidth; ++column) {
      const auto* rgb =
          &image[sizeof(sensors::ImageHeader) + 3 * static_cast<std::size_t>(row * kWidth + column)];
      if (std::to_integer<int>(rgb[0]) < 2 * std::to_integer<int>(rgb[2]) + 20) continue;
      sum += Eigen::Vector2d(column + 0.5, row + 0.5);
      ++count;
    }
  EXPECT_GT(count, 50);
  return sum / count;
}

TEST(EightCameras, SeeTheThrownBallWhereEachProjectsIt) {
  auto scene =
      scene::load_scene(std::filesystem::path(VISUM_SOURCE_DIR) / "models/scenes/eight_cameras.yaml");
  scene.clock = scene::ClockKind::kLockstep;
  cycle::Simulation simulation(std::move(scene));
  ASSERT_EQ(simulation.parts().size(), 8u);
  const sensors::Lens lens{kWidth, kHeight, 60 * M_PI / 180, -0.05, 0.005};
  for (const int ticks : {40, 300, 300}) {
    for (int i = 0; i < ticks; ++i) simulation.tick();
    for (std::size_t eye = 0; eye < 8; ++eye) {
      const auto image = simulation.parts()[eye].part->read_blackboard(0);
      sensors::ImageHeader header;
      std::memcpy(&header, image.data(), sizeof header);
      const double taken_s = static_cast<double>(header.taken_ns) * 1e-9;
      const Eigen::Vector3d ball(0, 0, 0.6 + 3 * taken_s - 9.81 / 2 * taken_s * taken_s);
      const double angle = static_cast<double>(eye) * M_PI / 4;
      const Eigen::Vector3d at(3 * std::cos(angle), 3 * std::sin(angle), 1.2);
      const Eigen::Quaterniond q = Eigen::AngleAxisd(angle + M_PI, Eigen::Vector3d::UnitZ()) *
                                   Eigen::AngleAxisd(std::atan(0.25), Eigen::Vector3d::UnitY());
      const Eigen::Vector3d seen = q.conjugate() * (ball - at);
      const auto expected = sensors::pixel_of(lens, {seen.x(), seen.y(), seen.z()});
      const auto found = middle_of_ball(image);
      EXPECT_NEAR(found.x(), expected[0], 0.5) << "eye_" << eye << " at " << taken_s << " s";
      EXPECT_NEAR(found.y(), expected[1], 0.5) << "eye_" << eye << " at " << taken_s << " s";
    }
  }
}

}  // namespace
}  // namespace visum::sensing

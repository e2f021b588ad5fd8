#include "hwparts/sensors/camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/hwparts/sensors/bench.h"
#include "tests/support/temp_files.h"

namespace visum::sensors {
namespace {

Lens lens(double k1 = 0.0, double k2 = 0.0) {
  return {640, 480, M_PI / 2, k1, k2};  // 90°: a focal length of 320 pixels
}

TEST(Lens, APinholeSeesPointsWhereTheyAre) {
  // 1 m to the left and 0.5 m up of the axis, 2 m ahead: 160 pixels to the left, 80 up.
  const auto pixel = pixel_of(lens(), {2.0, 1.0, 0.5});
  EXPECT_NEAR(pixel[0], 320 - 160, 1e-9);
  EXPECT_NEAR(pixel[1], 240 - 80, 1e-9);
  const auto direction = direction_of(lens(), 160, 160);
  EXPECT_NEAR(direction[1], 0.5, 1e-12);
  EXPECT_NEAR(direction[2], 0.25, 1e-12);
}

TEST(Lens, DistortionMovesPointsAlongTheirRadius) {
  // r = 0.5 focal lengths: 160 (1 - 0.2 x 0.25 + 0.05 x 0.0625) pixels.
  EXPECT_NEAR(pixel_of(lens(-0.2, 0.05), {1.0, -0.5, 0.0})[0], 320 + 160 * (1 - 0.05 + 0.003125), 1e-9);
  EXPECT_NEAR(pixel_of(lens(-0.2, 0.05), {1.0, -0.5, 0.0})[1], 240, 1e-12);
}

TEST(Lens, DirectionsAndPixelsAreEachOthersReverse) {
  for (const Lens& one : {lens(), lens(-0.2, 0.05), lens(0.3, 0.1)}) {
    for (double column = 0; column <= 640; column += 64)
      for (double row = 0; row <= 480; row += 48) {
        const auto back = pixel_of(one, direction_of(one, column, row));
        ASSERT_NEAR(back[0], column, 1e-9);
        ASSERT_NEAR(back[1], row, 1e-9);
      }
  }
}

std::string error_of(const std::string& keys) {
  return visum::test::TempFiles().error_of([&] { test::Bench bench("kind: camera, " + keys); });
}

TEST(Camera, WrongEntriesAreRefusedWhereTheyAreWrong) {
  const std::string size = "size: [64, 48]", fov = ", fov_deg: 60";
  EXPECT_EQ(error_of(size + fov), "no error");
  EXPECT_EQ(error_of("fov_deg: 60"), "sensor:1: key 'size' is missing");
  EXPECT_EQ(error_of("size: [64]" + fov), "sensor:1: size: must be [width, height]");
  EXPECT_EQ(error_of("size: [0, 48]" + fov),
            "sensor:1: size[0]: must be a whole number between 1 and 4096, is 0");
  EXPECT_EQ(error_of("size: [4096, 4096]" + fov), "sensor:1: size: a picture has at most 4194304 pixels");
  EXPECT_EQ(error_of(size), "sensor:1: key 'fov_deg' is missing");
  EXPECT_EQ(error_of(size + ", fov_deg: 180"), "sensor:1: fov_deg: must be between 1 and 170, is 180");
  EXPECT_EQ(error_of(size + ", fov_deg: 120, distortion: [-0.9, 0]"),
            "sensor:1: distortion: folds the picture over itself before its corners");
  EXPECT_EQ(error_of(size + fov + ", shows: colour"),
            "sensor:1: shows: must be one of color, depth, segmentation, is 'colour'; did you mean 'color'?");
  EXPECT_EQ(error_of(size + fov + ", shows: depth, exposure: 2"),
            "sensor:1: exposure: a camera that shows this has none");
  EXPECT_EQ(error_of(size + fov + ", shows: segmentation, noise: 0.1"),
            "sensor:1: noise: a camera that shows this has none");
  EXPECT_EQ(error_of(size + fov + ", noise_share: 0.1"),
            "sensor:1: noise_share: a camera that shows this has none");
  EXPECT_EQ(error_of(size + fov + ", failure: garbage"),
            "sensor:1: failure: a camera does not fail in this way");
}

}  // namespace
}  // namespace visum::sensors

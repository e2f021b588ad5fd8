// Pictures on surfaces, as cameras see them, and files that are no pictures.
#include <gtest/gtest.h>
#include <png.h>

#include <cmath>
#include <cstdio>
// After <cstdio>, which it needs.
#include <jpeglib.h>

#include <cstdlib>
#include <cstring>

#include "hwparts/sensors/camera.h"
#include "server/sensing/read_picture.h"
#include "server/sensing/texture.h"
#include "tests/sensing/world_bench.h"

namespace visum::sensing {
namespace {

using Eigen::Vector3d;
using test::WorldBench;

std::string png_of(int width, int height, const std::vector<std::uint8_t>& rgb) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<unsigned>(width);
  image.height = static_cast<unsigned>(height);
  image.format = PNG_FORMAT_RGB;
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = bytes.size();
  EXPECT_TRUE(png_image_write_to_memory(&image, bytes.data(), &size, 0, rgb.data(), 0, nullptr))
      << image.message;
  bytes.resize(size);
  return bytes;
}

std::string jpeg_of(int width, int height, const std::vector<std::uint8_t>& rgb) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = static_cast<JDIMENSION>(width);
  jpeg.image_height = static_cast<JDIMENSION>(height);
  jpeg.input_components = 3;
  jpeg.in_color_space = JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 100, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  while (jpeg.next_scanline < jpeg.image_height) {
    auto* row = const_cast<JSAMPROW>(&rgb[std::size_t{3} * jpeg.next_scanline * jpeg.image_width]);
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  std::string result(reinterpret_cast<char*>(bytes), size);
  std::free(bytes);
  return result;
}

// Two by two: red and green above, blue and white below.
const std::vector<std::uint8_t> kFour{255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255};

TEST(Texture, LiesBetweenTheFourNearestPixelsAndGoesOn) {
  const Texture texture({"four.png", "image/png", png_of(2, 2, kFour)});
  EXPECT_EQ(texture.at(0.25, 0.75), Vector3d(1, 0, 0));
  EXPECT_EQ(texture.at(0.75, 0.75), Vector3d(0, 1, 0));
  EXPECT_EQ(texture.at(0.25, 0.25), Vector3d(0, 0, 1));
  EXPECT_EQ(texture.at(-0.25, 3.25), Vector3d(1, 1, 1)) << "tiles go on in both directions";
  EXPECT_EQ(texture.at(0.5, 0.75), Vector3d(0.5, 0.5, 0));
  EXPECT_EQ(texture.at(0.5, 0.5), Vector3d(0.5, 0.5, 0.5));
  EXPECT_EQ(texture.at(0.0, 0.75), Vector3d(0.5, 0.5, 0)) << "and on over a tile's edge";
}

TEST(Texture, SmallerCopiesAnswerWhereAPixelSeesMuchOfIt) {
  const Texture texture({"four.png", "image/png", png_of(2, 2, kFour)});
  const Vector3d mean = Vector3d::Constant(128) / 255;
  EXPECT_EQ(texture.at(0.25, 0.75, 0.5), Vector3d(1, 0, 0)) << "a pixel for a pixel";
  EXPECT_EQ(texture.at(0.25, 0.75, 1.0), mean);
  EXPECT_EQ(texture.at(0.25, 0.75, 1000.0), mean);
  EXPECT_LT((texture.at(0.25, 0.75, 0.75) - (Vector3d(1, 0, 0) + mean) / 2).norm(), 1e-12);
}

TEST(Texture, AJpegIsReadAsWell) {
  std::vector<std::uint8_t> grey;
  for (int i = 0; i < 16 * 8; ++i) grey.insert(grey.end(), {200, 120, 40});
  const Texture texture({"plain.jpg", "image/jpeg", jpeg_of(16, 8, grey)});
  EXPECT_LT((texture.at(0.3, 0.6) - Vector3d(200, 120, 40) / 255).norm(), 3.0 / 255);
}

std::string error_of(const std::string& type, const std::string& bytes) {
  try {
    Texture({"floor", type, bytes});
  } catch (const config::ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(Texture, SaysWhichPictureCannotBeRead) {
  const std::string png = png_of(2, 2, kFour);
  EXPECT_NE(
      error_of("image/png", png.substr(0, png.size() / 2)).find("floor: a camera cannot read this picture: "),
      std::string::npos);
  const std::string jpeg = jpeg_of(2, 2, kFour);
  EXPECT_NE(error_of("image/jpeg", jpeg.substr(0, jpeg.size() / 2)).find("cannot read this picture: "),
            std::string::npos);
  EXPECT_NE(error_of("image/jpeg", "\xff\xd8\xff").find("cannot read this picture: "), std::string::npos);
}

// The header alone says 60,000 x 60,000: no memory is taken for it.
TEST(Texture, RefusesMorePixelsThanThereMayBe) {
  std::string png = png_of(2, 2, kFour);
  const unsigned char side[] = {0, 0, 0xea, 0x60};
  std::memcpy(&png[16], side, 4);
  std::memcpy(&png[20], side, 4);
  // Its check sum, over type and data.
  std::uint32_t sum = 0xffffffff;
  for (std::size_t i = 12; i < 29; ++i) {
    sum ^= static_cast<unsigned char>(png[i]);
    for (int bit = 0; bit < 8; ++bit) sum = (sum >> 1) ^ ((sum & 1) ? 0xedb88320u : 0u);
  }
  sum = ~sum;
  for (int i = 0; i < 4; ++i) png[29 + static_cast<std::size_t>(i)] = static_cast<char>(sum >> (24 - 8 * i));
  EXPECT_EQ(error_of("image/png", png),
            "floor: a camera cannot read this picture: it has 60000 x 60000 pixels; 16777216 are the most");
}

std::array<double, 2> place(world::ShapeKind kind, std::array<double, 3> size, Vector3d p, Vector3d normal) {
  world::Shape shape;
  shape.kind = kind;
  shape.size = size;
  const auto found = place_on(shape, p, normal);
  return found ? *found : std::array{-1.0, -1.0};
}

// Seen from outside with z up, the lower left corner of each side is (0, 0).
TEST(Texture, LiesOnEachFaceOfABoxForItself) {
  const std::array<double, 3> size{2, 4, 6};
  const auto on = [&](Vector3d p, Vector3d normal) { return place(world::ShapeKind::kBox, size, p, normal); };
  EXPECT_EQ(on({-1, -2, 3}, {0, 0, 1}), (std::array{0.0, 0.0}));
  EXPECT_EQ(on({0.5, -1.5, 3}, {0, 0, 1}), (std::array{1.5, 0.5}));
  EXPECT_EQ(on({1, -2, 3}, {1, 0, 0}), (std::array{0.0, 0.0}));
  EXPECT_EQ(on({1, -1, 1}, {1, 0, 0}), (std::array{2.0, 1.0}));
  EXPECT_EQ(on({-1, 2, 1}, {0, 1, 0}), (std::array{0.0, 2.0}));
}

TEST(Texture, GoesAroundWhatIsRoundInMetres) {
  const auto bar = [&](Vector3d p) {
    return place(world::ShapeKind::kCylinder, {0.5, 2.0, 0}, p, Vector3d(p.x(), p.y(), 0).normalized());
  };
  EXPECT_NEAR(bar({0, -0.5, -1})[0], 0.0, 1e-12);
  EXPECT_NEAR(bar({0.5, 0, 0.25})[0], 0.5 * M_PI / 2, 1e-12);
  EXPECT_NEAR(bar({0.5, 0, 0.25})[1], 1.25, 1e-12);
  const auto ball = place(world::ShapeKind::kSphere, {2, 0, 0}, {0, 2, 0}, {0, 1, 0});
  EXPECT_NEAR(ball[1], 2 * M_PI, 1e-12) << "the upper pole";
}

// A camera looks straight down from 2 m; its pixels show the floor's tiles of 0.5 m where the pinhole says.
TEST(Texture, IsSeenByACameraWhereItLies) {
  const visum::test::TempFiles files;
  std::vector<std::uint8_t> rgb;
  for (int row = 0; row < 8; ++row)
    for (int column = 0; column < 8; ++column)
      rgb.insert(rgb.end(),
                 {static_cast<std::uint8_t>(column * 30), static_cast<std::uint8_t>(row * 30), 90});
  const std::string png = png_of(8, 8, rgb);
  files.write("tile.png", png);
  const auto scene = files.write("s.yaml", R"(
visum: 1
clock: lockstep
lights: [{kind: ambient, intensity: 1}]
materials: {tiles: {texture: tile.png, texture_size: [0.5, 0.5]}}
bodies: [{name: floor, fixed: true, shapes: [{plane: true, material: tiles}]}]
sensors: [{name: eye, kind: camera, size: [60, 40], fov_deg: 60, pose: {xyz: [0.1, 0.2, 2], rpy: [0, 1.5707963267948966, 0]}}]
)");
  cycle::Simulation simulation(scene::load_scene(scene));
  simulation.tick();
  const auto image = simulation.parts().front().part->read_blackboard(0);
  const Texture texture({"tile.png", "image/png", png});
  const sensors::Lens lens{60, 40, 60 * M_PI / 180, 0.0, 0.0};
  for (int row = 0; row < 40; row += 3) {
    for (int column = 0; column < 60; column += 3) {
      const auto d = sensors::direction_of(lens, column + 0.5, row + 0.5);
      // The camera's x points down, its z along the world's x.
      const double x = 0.1 + 2 * d[2], y = 0.2 + 2 * d[1];
      const Vector3d expected = texture.at((x + 30) / 0.5, (y + 30) / 0.5);
      for (int channel = 0; channel < 3; ++channel) {
        const auto at = sizeof(sensors::ImageHeader) + 3 * static_cast<std::size_t>(row * 60 + column);
        EXPECT_NEAR(std::to_integer<int>(image[at + static_cast<std::size_t>(channel)]),
                    255 * expected[channel], 0.51)
            << column << ", " << row << ", " << channel;
      }
    }
  }
}

}  // namespace
}  // namespace visum::sensing

#include "clients/visum/common/picture.h"

#include <gtest/gtest.h>
#include <png.h>
#include <sys/resource.h>

#include <csignal>
#include <cstring>
#include <fstream>

#include "tests/support/temp_files.h"

namespace visum::cli {
namespace {

struct Header {
  std::uint32_t bytes = 24, width = 3, height = 2, shows = 0;
  std::int64_t taken_ns = 5;
};

std::vector<std::byte> blackboard(const Header& header, std::size_t pixel_bytes) {
  std::vector<std::byte> bytes(sizeof header + pixel_bytes);
  std::memcpy(bytes.data(), &header, sizeof header);
  for (std::size_t i = 0; i < pixel_bytes; ++i) bytes[sizeof header + i] = static_cast<std::byte>(10 * i);
  return bytes;
}

std::string error_of(const std::vector<std::byte>& bytes) {
  try {
    read_picture(bytes);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "no error";
}

// As another program would read the file.
template <typename T>
std::vector<T> read_back(const std::filesystem::path& file, std::uint32_t format) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_NE(png_image_begin_read_from_file(&image, file.c_str()), 0) << image.message;
  EXPECT_EQ(image.width, 3u);
  EXPECT_EQ(image.height, 2u);
  image.format = format;
  std::vector<T> pixels(PNG_IMAGE_SIZE(image) / sizeof(T));
  EXPECT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0) << image.message;
  return pixels;
}

TEST(Picture, ColorsAreWrittenAsTheyAre) {
  const test::TempFiles files;
  const Picture picture = read_picture(blackboard({}, 18));
  EXPECT_EQ(picture.taken_ns, 5);
  write_png(picture, files.folder() / "a.png");
  const auto pixels = read_back<std::uint8_t>(files.folder() / "a.png", PNG_FORMAT_RGB);
  ASSERT_EQ(pixels.size(), 18u);
  for (std::size_t i = 0; i < 18; ++i) EXPECT_EQ(pixels[i], 10 * i);
}

TEST(Picture, DepthsAreWrittenInMillimetres) {
  const test::TempFiles files;
  Picture picture{3, 2, Picture::Shows::kDepth, 0, std::vector<std::byte>(24)};
  const float metres[] = {0.0f, 0.001f, 1.2344f, 65.535f, 70.0f, 2.0f};
  std::memcpy(picture.pixels.data(), metres, sizeof metres);
  write_png(picture, files.folder() / "a.png");
  EXPECT_EQ(read_back<std::uint16_t>(files.folder() / "a.png", PNG_FORMAT_LINEAR_Y),
            (std::vector<std::uint16_t>{0, 1, 1234, 65535, 65535, 2000}));
}

TEST(Picture, BodiesAreWrittenAsNumbers) {
  const test::TempFiles files;
  Picture picture{3, 2, Picture::Shows::kSegmentation, 0, std::vector<std::byte>(12)};
  const std::uint16_t bodies[] = {0, 1, 2, 300, 9999, 7};
  std::memcpy(picture.pixels.data(), bodies, sizeof bodies);
  write_png(picture, files.folder() / "a.png");
  EXPECT_EQ(read_back<std::uint16_t>(files.folder() / "a.png", PNG_FORMAT_LINEAR_Y),
            (std::vector<std::uint16_t>(bodies, bodies + 6)));
}

TEST(Picture, BytesThatAreNoneAreRefused) {
  EXPECT_EQ(error_of(std::vector<std::byte>(23)), "this is no picture: it is too short");
  EXPECT_EQ(error_of(blackboard({}, 17)), "this is no picture: its size is not what it says");
  EXPECT_EQ(error_of(blackboard({24, 0xFFFFFFFF, 0xFFFFFFFF}, 18)),
            "this is no picture: its size is not what it says");
  EXPECT_EQ(error_of(blackboard({24, 3, 2, 3}, 18)), "this is no picture that is known here");
  EXPECT_EQ(error_of(blackboard({99, 3, 2}, 18)), "this is no picture that is known here");
  EXPECT_EQ(error_of(blackboard({0, 3, 2}, 18)), "this is no picture that is known here");
}

TEST(Picture, AFileThatCannotBeWrittenSaysSo) {
  EXPECT_THROW(write_png(read_picture(blackboard({}, 18)), "/nowhere/a.png"), std::runtime_error);
}

TEST(Picture, AFullDiskLeavesTheEarlierOne) {
  const test::TempFiles files;
  const auto file = files.folder() / "a.png";
  std::ofstream(file) << "mine";
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit full{0, limit.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &full), 0);
  EXPECT_THROW(write_png(read_picture(blackboard({}, 18)), file), std::runtime_error);
  ::setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, before);
  EXPECT_EQ(std::filesystem::file_size(file), 4u);
  const std::filesystem::directory_iterator there(files.folder());
  EXPECT_EQ(std::distance(begin(there), end(there)), 1);
}

TEST(Picture, WhatIsNoPlainFileIsNeverRemoved) {
  const test::TempFiles files;
  const auto link = files.folder() / "full";
  std::filesystem::create_symlink("/dev/full", link);
  EXPECT_THROW(write_png(read_picture(blackboard({}, 18)), link), std::runtime_error);
  EXPECT_TRUE(std::filesystem::is_symlink(link));
}

}  // namespace
}  // namespace visum::cli

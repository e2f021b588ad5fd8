#include "clients/visum/common/picture.h"

#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "clients/visum/common/whole_file.h"

namespace visum::cli {
namespace {

// The blackboard begins with these, little-endian: bytes of this header, width, height, what it shows, and
// when it was taken.
struct Header {
  std::uint32_t bytes, width, height, shows;
  std::int64_t taken_ns;
};

std::size_t bytes_per_pixel(Picture::Shows shows) {
  return shows == Picture::Shows::kColor ? 3 : shows == Picture::Shows::kDepth ? 4 : 2;
}

std::vector<std::uint16_t> as_millimetres(std::span<const std::byte> pixels) {
  std::vector<std::uint16_t> result(pixels.size() / sizeof(float));
  for (std::size_t i = 0; i < result.size(); ++i) {
    float metres = 0.0f;
    std::memcpy(&metres, pixels.data() + i * sizeof metres, sizeof metres);
    result[i] = static_cast<std::uint16_t>(std::clamp(std::round(metres * 1000.0f), 0.0f, 65535.0f));
  }
  return result;
}

void write(const std::filesystem::path& file, const Picture& picture, std::uint32_t format,
           const void* pixels) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = picture.width;
  image.height = picture.height;
  image.format = format;
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<char> png(bytes);
  if (png_image_write_to_memory(&image, png.data(), &bytes, 0, pixels, 0, nullptr) == 0)
    throw std::runtime_error("cannot write " + file.string() + ": " + image.message);
  write_whole_file(file, std::span(png).first(bytes));
}

}  // namespace

Picture read_picture(std::span<const std::byte> blackboard) {
  Header header{};
  if (blackboard.size() < sizeof header) throw std::runtime_error("this is no picture: it is too short");
  std::memcpy(&header, blackboard.data(), sizeof header);
  if (header.bytes < sizeof header || header.bytes > blackboard.size() || header.shows > 2)
    throw std::runtime_error("this is no picture that is known here");
  Picture picture{
      header.width, header.height, static_cast<Picture::Shows>(header.shows), header.taken_ns, {}};
  const auto pixels = blackboard.subspan(header.bytes);
  if (std::uint64_t{header.width} * header.height * bytes_per_pixel(picture.shows) != pixels.size())
    throw std::runtime_error("this is no picture: its size is not what it says");
  picture.pixels.assign(pixels.begin(), pixels.end());
  return picture;
}

void write_png(const Picture& picture, const std::filesystem::path& file) {
  if (picture.shows == Picture::Shows::kColor)
    return write(file, picture, PNG_FORMAT_RGB, picture.pixels.data());
  // libpng's 16-bit format is "linear": it stores the numbers as they are.
  if (picture.shows == Picture::Shows::kDepth)
    return write(file, picture, PNG_FORMAT_LINEAR_Y, as_millimetres(picture.pixels).data());
  std::vector<std::uint16_t> bodies(picture.pixels.size() / sizeof(std::uint16_t));
  std::memcpy(bodies.data(), picture.pixels.data(), picture.pixels.size());
  write(file, picture, PNG_FORMAT_LINEAR_Y, bodies.data());
}

}  // namespace visum::cli

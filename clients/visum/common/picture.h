// Reads a camera's picture from its blackboard `image` and writes it as a PNG file. libpng stays inside
// picture.cc.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace visum::cli {

struct Picture {
  enum class Shows : std::uint32_t { kColor, kDepth, kSegmentation };
  std::uint32_t width = 0, height = 0;
  Shows shows = Shows::kColor;
  std::int64_t taken_ns = -1;     // simulated; -1: none yet
  std::vector<std::byte> pixels;  // row by row from the top: RGB bytes, 32-bit floats (m), 16 bits (body + 1)
};

// Throws std::runtime_error if the bytes are not a picture.
Picture read_picture(std::span<const std::byte> blackboard);

// Colours as 8-bit RGB; depths as 16-bit grey in mm, larger ones as 65.535 m; bodies as 16-bit grey.
// Throws std::runtime_error with the reason; an older `file` then stays as it was.
void write_png(const Picture& picture, const std::filesystem::path& file);

}  // namespace visum::cli

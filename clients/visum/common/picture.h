// A camera's picture as its blackboard `image` holds it, and as a PNG file. libpng stays inside picture.cc.
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

// Throws std::runtime_error where the bytes are no picture.
Picture read_picture(std::span<const std::byte> blackboard);

// Colours as 8-bit RGB; depths as 16-bit grey in mm, what is beyond 65.535 m as that; bodies as 16-bit grey.
// Throws std::runtime_error with the reason; what stood in `file` before is there still, then.
void write_png(const Picture& picture, const std::filesystem::path& file);

}  // namespace visum::cli

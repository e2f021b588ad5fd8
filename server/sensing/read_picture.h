// PNG and JPEG pictures to plain pixels. libpng and libjpeg stay inside read_picture.cc.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace visum::sensing {

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // row by row from the top; what is transparent shows its colour
};

// `content_type`: image/png or image/jpeg. Returns what is wrong, in words; empty: read. Whatever the bytes
// say, no more memory is taken than for `max_pixels`, and no more than kMaxScans passes over them are made.
std::string read_picture(const std::string& content_type, const std::string& bytes, int max_side,
                         int max_pixels, Picture& picture);

inline constexpr int kMaxScans = 100;  // of a progressive JPEG; ten are usual

}  // namespace visum::sensing

// Reads PNG and JPEG pictures into plain pixels. The bytes may be hostile: memory and time are bounded.
// libpng and libjpeg stay inside read_picture.cc. Pure function; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace visum::sensing {

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // row by row from the top; transparency is ignored
};

// `content_type`: image/png or image/jpeg. Returns what is wrong, in words; empty: the picture was read.
// Whatever the bytes say, it takes no more memory than `max_pixels` need and makes no more than kMaxScans
// passes over them.
std::string read_picture(const std::string& content_type, const std::string& bytes, int max_side,
                         int max_pixels, Picture& picture);

inline constexpr int kMaxScans = 100;  // of a progressive JPEG; usual are ten

}  // namespace visum::sensing

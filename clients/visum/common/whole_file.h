// A file that takes the place of an earlier one only once it is whole. What is no plain file (a pipe, a link,
// a device) is written at once.
#pragma once

#include <filesystem>
#include <span>

namespace visum::cli {

// Throws std::runtime_error with the reason; nothing is left of what could not be written.
void write_whole_file(const std::filesystem::path& file, std::span<const char> bytes);

}  // namespace visum::cli

// Writes a file in one go (protocol/config/new_file.h): readers see the older one or the whole new one.
#pragma once

#include <filesystem>
#include <span>

namespace visum::cli {

// Throws std::runtime_error with the reason. A file that could not be written whole is removed.
void write_whole_file(const std::filesystem::path& file, std::span<const char> bytes);

}  // namespace visum::cli

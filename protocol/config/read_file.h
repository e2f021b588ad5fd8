// Reads a whole file into memory, but never more than was agreed: the size is checked before a byte is read.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace visum::config {

struct FileContent {
  std::string bytes;
  std::string fault;  // why it could not be read, "no such file"; empty: it was
};

// Never throws for a file that is missing, forbidden, no regular file (a folder, a pipe) or larger than
// `max_bytes`.
FileContent read_file(const std::filesystem::path& path, std::size_t max_bytes);

}  // namespace visum::config

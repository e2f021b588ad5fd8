// Reads a whole file into memory, but never more than was agreed: the size is checked before a byte is read.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

namespace visum::config {

struct FileContent {
  std::string bytes;
  std::string fault;  // why it could not be read, "no such file"; empty: it was
};

// Never throws for a file that is missing, forbidden, no regular file (a folder, a pipe) or larger than
// `max_bytes`.
FileContent read_file(const std::filesystem::path& path, std::size_t max_bytes);

// Whether it is there to be read, for those who look for a file in several places.
bool is_file(const std::filesystem::path& path);

// Contents by absolute path without "." and "..".
using Files = std::map<std::string, std::string>;

// Keeps what read_file() reads on this thread while the object lives.
class FilesNoted {
 public:
  FilesNoted();
  ~FilesNoted();
  FilesNoted(const FilesNoted&) = delete;
  FilesNoted& operator=(const FilesNoted&) = delete;
  Files files;
};

// While the object lives these are all the files that there are to read_file() and is_file() on this thread:
// the disk is not asked. They have to live as long; objects may stand within each other.
class FilesGiven {
 public:
  explicit FilesGiven(const Files& all);
  ~FilesGiven();
  FilesGiven(const FilesGiven&) = delete;
  FilesGiven& operator=(const FilesGiven&) = delete;
  const Files& files;

 private:
  const FilesGiven* const before_;
};

}  // namespace visum::config

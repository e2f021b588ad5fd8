// Reads a whole file into memory, but at most `max_bytes`: the size is checked before a byte is read.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

namespace visum::config {

struct FileContent {
  std::string bytes;
  std::string fault;  // why it could not be read, "no such file"; empty if it was read
};

// Does not throw. `fault` is set if the file is missing, may not be read, is no regular file (a folder, a
// pipe), or is larger than `max_bytes`.
FileContent read_file(const std::filesystem::path& path, std::size_t max_bytes);

// True if there is a file that can be read. For callers that look for a file in several places.
bool is_file(const std::filesystem::path& path);

// One path for all ways to write a file's path: absolute, without ".", "..", and links as far as the disk
// tells. Where files are given (FilesGiven), the disk is not asked.
std::filesystem::path identity_of(const std::filesystem::path& path);

// Contents by absolute path without "." and "..".
using Files = std::map<std::string, std::string>;

// Lets FilesNoted keep other bytes for a file than those on the disk: what a program made of it.
void note_file(const std::filesystem::path& path, const std::string& bytes);

// While the object lives, collects what read_file() reads on this thread.
class FilesNoted {
 public:
  FilesNoted();
  ~FilesNoted();
  FilesNoted(const FilesNoted&) = delete;
  FilesNoted& operator=(const FilesNoted&) = delete;
  Files files;
};

// While the object lives, read_file() and is_file() on this thread see only these files and not the disk. A
// replay reads its scene this way. The files must outlive the object. Objects may be nested.
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

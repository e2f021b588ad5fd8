// A plain file that is read without trust in what it is: nobody waits for the other end of a pipe.
#pragma once

#include <sys/stat.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace visum::scene {

class PlainFile {
 public:
  explicit PlainFile(const std::filesystem::path& path);  // does not throw: see is_open()
  ~PlainFile();
  PlainFile(const PlainFile&) = delete;
  PlainFile& operator=(const PlainFile&) = delete;

  bool is_open() const { return fd_ >= 0; }  // false: there is none that may be read, or it is no plain file
  const struct stat& status() const { return status_; }
  // Fewer bytes where the file ends, or cannot be read.
  std::string read_at(std::uint64_t offset, std::size_t bytes) const;

 private:
  int fd_ = -1;
  struct stat status_ {};
};

}  // namespace visum::scene

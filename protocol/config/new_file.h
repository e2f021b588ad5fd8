// A file that replaces an older one only once it is whole. Any thread.
#pragma once

#include <filesystem>

namespace visum::config {

// Write to path(), then call keep(). Until then an older file of that name stays as it is. A pipe, a link or
// a device cannot be replaced, so for these path() is the file itself.
class NewFile {
 public:
  explicit NewFile(std::filesystem::path file);
  ~NewFile();  // without keep(), removes what was written
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  const std::filesystem::path& path() const { return path_; }  // beside the file, with the process's number
  void keep() const;                                           // throws std::filesystem::filesystem_error

 private:
  std::filesystem::path file_, path_;
};

}  // namespace visum::config

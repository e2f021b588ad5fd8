// A file that takes the place of another one only once it is whole. What is no plain file (a pipe, a link) is
// written at once.
#pragma once

#include <filesystem>

namespace visum::recording {

class NewFile {
 public:
  explicit NewFile(std::filesystem::path file);
  ~NewFile();  // not kept: nothing is left of it
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  const std::filesystem::path& path() const { return path_; }  // what is to be written
  void keep() const;                                           // throws std::filesystem::filesystem_error

 private:
  std::filesystem::path file_, path_;
};

}  // namespace visum::recording

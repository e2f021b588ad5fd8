// A file that replaces another one only once it is complete: it is written beside it and renamed by keep(). A
// path that is not a plain file (a pipe, a link) is written directly.
#pragma once

#include <filesystem>

namespace visum::recording {

class NewFile {
 public:
  explicit NewFile(std::filesystem::path file);
  ~NewFile();  // removes the file where it was not kept
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;

  const std::filesystem::path& path() const { return path_; }  // to be opened and written by the caller
  void keep() const;                                           // throws std::filesystem::filesystem_error

 private:
  std::filesystem::path file_, path_;
};

}  // namespace visum::recording

// A file that replaces another one only once it is complete: it is written beside it and renamed by keep(). A
// path that is not a plain file (a pipe, a link) is written directly. Any thread.
#pragma once

#include <filesystem>
#include <string_view>

namespace visum::config {

// The path beside `file` whose name is that of `file` with `after` at its end. A name that would be longer
// than the file system's names (255 bytes) is cut, and gets a hash of the whole name before `after`, so that
// no two files share it.
std::filesystem::path name_beside(const std::filesystem::path& file, std::string_view after);

// Write to path(), then call keep(). Until then an older file of that name stays as it is. A pipe, a link or
// a device cannot be replaced, so for these path() is the file itself.
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

}  // namespace visum::config

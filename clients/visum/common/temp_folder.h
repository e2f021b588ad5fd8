// A temporary folder; the destructor removes it with all that is in it. One thread.
#pragma once

#include <filesystem>

namespace visum::cli {

class TempFolder {
 public:
  TempFolder();  // under $TMPDIR or /tmp, for our user alone; throws ExitError(kFailed)
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace visum::cli

// A folder of our own for as long as this object lives; removed with all that is in it.
#pragma once

#include <filesystem>

namespace visum::cli {

class TempFolder {
 public:
  TempFolder();  // under $TMPDIR or /tmp, for us alone. Throws ExitError(kFailed) where there is no room.
  ~TempFolder();
  TempFolder(const TempFolder&) = delete;
  TempFolder& operator=(const TempFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace visum::cli

#include "clients/visum/common/temp_folder.h"

#include <stdlib.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "clients/visum/common/exit_code.h"

namespace visum::cli {

TempFolder::TempFolder() {
  std::error_code error;
  std::string pattern = (std::filesystem::temp_directory_path(error) / "visum-XXXXXX").string();
  if (error || !::mkdtemp(pattern.data()))
    throw ExitError(kFailed, "cannot make a temporary folder: " + std::string(std::strerror(errno)));
  path_ = pattern;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace visum::cli

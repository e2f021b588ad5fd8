#include "protocol/config/new_file.h"

#include <unistd.h>

#include <string>
#include <system_error>

namespace visum::config {

NewFile::NewFile(std::filesystem::path file) : file_(std::move(file)), path_(file_) {
  std::error_code none;
  const auto there = std::filesystem::symlink_status(file_, none);
  if (file_.empty() || (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there))) return;
  path_ = file_.string() + ".part" + std::to_string(::getpid());
}

NewFile::~NewFile() {
  std::error_code none;
  if (path_ != file_) std::filesystem::remove(path_, none);
}

void NewFile::keep() const {
  if (path_ != file_) std::filesystem::rename(path_, file_);
}

}  // namespace visum::config

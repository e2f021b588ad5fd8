#include "protocol/config/new_file.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <string>
#include <system_error>

namespace visum::config {
namespace {

// Bytes of a name in the folder of this file.
std::size_t longest_name(const std::filesystem::path& file) {
  constexpr std::size_t kUsual = 255;
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  const long longest = ::pathconf(folder.c_str(), _PC_NAME_MAX);
  return longest > 0 ? static_cast<std::size_t>(longest) : kUsual;
}

// Cuts no character of UTF-8 in two, because some file systems refuse such names.
void cut_to(std::string& name, std::size_t bytes) {
  while (bytes > 0 && (static_cast<unsigned char>(name[bytes]) & 0xc0) == 0x80) --bytes;
  name.resize(bytes);
}

}  // namespace

std::filesystem::path name_beside(const std::filesystem::path& file, std::string_view after) {
  std::string name = file.filename().string();
  const std::size_t longest = longest_name(file);
  if (name.size() + after.size() > longest) {
    char hash[18];
    std::snprintf(hash, sizeof hash, "~%016zx", std::hash<std::string>{}(name));
    const std::size_t taken = sizeof hash - 1 + after.size();
    cut_to(name, longest > taken ? std::min(name.size(), longest - taken) : 0);
    name += hash;
  }
  return file.parent_path() / name.append(after);
}

NewFile::NewFile(std::filesystem::path file) : file_(std::move(file)), path_(file_) {
  std::error_code none;
  const auto there = std::filesystem::symlink_status(file_, none);
  if (file_.empty() || (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there))) return;
  if (none == std::errc::filename_too_long) return;  // to open it says so
  path_ = name_beside(file_, ".part" + std::to_string(::getpid()));
}

NewFile::~NewFile() {
  std::error_code none;
  if (path_ != file_) std::filesystem::remove(path_, none);
}

void NewFile::keep() const {
  if (path_ != file_) std::filesystem::rename(path_, file_);
}

}  // namespace visum::config

#include "clients/visum/common/whole_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <system_error>

namespace visum::cli {
namespace {

namespace fs = std::filesystem;

bool is_plain_or_new(const fs::path& file) {
  std::error_code none;
  const auto there = fs::symlink_status(file, none);
  return !fs::exists(there) || fs::is_regular_file(there);
}

// Returns the reason where it fails.
std::string write_bytes(const fs::path& file, std::span<const char> bytes) {
  errno = 0;
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (out) return {};
  return errno != 0 ? std::strerror(errno) : "it is not whole";
}

}  // namespace

void write_whole_file(const fs::path& file, std::span<const char> bytes) {
  const bool aside = is_plain_or_new(file);
  const fs::path written = aside ? fs::path(file.string() + ".part" + std::to_string(::getpid())) : file;
  auto failure = write_bytes(written, bytes);
  std::error_code error;
  if (aside && failure.empty()) fs::rename(written, file, error);
  if (error) failure = error.message();
  if (failure.empty()) return;
  if (aside) fs::remove(written, error);
  throw std::runtime_error("cannot write " + file.string() + ": " + failure);
}

}  // namespace visum::cli

#include "clients/visum/common/whole_file.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <system_error>

#include "protocol/config/new_file.h"

namespace visum::cli {
namespace {

namespace fs = std::filesystem;

// Returns why it failed, or nothing.
std::string write_bytes(const fs::path& file, std::span<const char> bytes) {
  errno = 0;
  std::ofstream out(file, std::ios::binary | std::ios::trunc);
  out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  out.close();
  if (out) return {};
  return errno != 0 ? std::strerror(errno) : "it was cut short";
}

}  // namespace

void write_whole_file(const fs::path& file, std::span<const char> bytes) {
  const config::NewFile made(file);
  std::string failure = write_bytes(made.path(), bytes);
  try {
    if (failure.empty()) return made.keep();
  } catch (const fs::filesystem_error& error) {
    failure = error.code().message();
  }
  throw std::runtime_error("cannot write " + file.string() + ": " + failure);
}

}  // namespace visum::cli

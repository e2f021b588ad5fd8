#include "server/programs/used_files.h"

#include <xxhash.h>

#include <cstdio>
#include <fstream>
#include <set>
#include <stdexcept>

#include "protocol/config/new_file.h"

namespace visum::programs {
namespace {

constexpr std::size_t kMaxLibraryBytes = std::size_t{1} << 30;

std::string line_of(const std::string& path, const std::string& bytes) {
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016llx",
                static_cast<unsigned long long>(XXH64(bytes.data(), bytes.size(), 0)));
  return std::string(hash) + " " + path + "\n";
}

// Files that are mapped as code, but for the system's and this program.
std::set<std::string> libraries() {
  std::set<std::string> found;
  std::error_code none;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", none).string();
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    const auto slash = line.find('/');
    if (slash == line.npos || line.find(".so") == line.npos) continue;
    const std::string path = line.substr(slash);
    const bool systems = path.starts_with("/usr/lib/") || path.starts_with("/lib");
    if (!systems && path != self && std::filesystem::is_regular_file(path, none)) found.insert(path);
  }
  return found;
}

}  // namespace

void write_used_files(const config::Files& read, const std::string& to) {
  const config::NewFile file(to);
  std::ofstream out(file.path());
  for (const auto& [path, bytes] : read) out << line_of(path, bytes);
  for (const auto& path : libraries()) {
    const auto content = config::read_file(path, kMaxLibraryBytes);
    if (!content.fault.empty()) throw std::runtime_error(path + ": " + content.fault);
    out << line_of(path, content.bytes);
  }
  out.close();
  if (!out) throw std::runtime_error("cannot write " + to);
  file.keep();
}

}  // namespace visum::programs

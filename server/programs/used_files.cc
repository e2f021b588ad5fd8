#include "server/programs/used_files.h"

#include <link.h>
#include <xxhash.h>

#include <cstdio>
#include <fstream>
#include <set>
#include <stdexcept>
#include <string_view>

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

// The shared libraries of this process, but for the system's.
std::set<std::string> libraries() {
  std::set<std::string> found;
  const auto take = [](dl_phdr_info* library, std::size_t, void* into) {
    // This program has an empty name, and what the kernel adds has no folder.
    const std::string_view path = library->dlpi_name;
    if (path.find('/') != path.npos && !path.starts_with("/usr/lib/") && !path.starts_with("/lib"))
      static_cast<std::set<std::string>*>(into)->insert(std::filesystem::canonical(path).string());
    return 0;
  };
  ::dl_iterate_phdr(take, &found);
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

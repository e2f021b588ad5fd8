#include "protocol/plugin/library.h"

#include <dlfcn.h>
#include <sys/stat.h>

#include <algorithm>
#include <system_error>

namespace visum::plugin {
namespace {

namespace fs = std::filesystem;

// Refuses anything but a plain name, so that a scene cannot name a path.
void check_name(const std::string& name) {
  const bool plain = std::ranges::all_of(name, [](unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  if (name.empty() || name.size() > 64 || !plain)
    throw Error("a plug-in's name has 1 to 64 letters, digits, _ and -, and no folder or ending");
}

void refuse_if_anybody_may_write(const fs::path& path) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) throw Error("cannot look at '" + path.string() + "'");
  if ((status.st_mode & S_IWOTH) != 0)
    throw Error("anybody may write to '" + path.string() + "', so nothing is loaded from there");
}

// Finds the library's file. It may be a link, but not to a place outside of its folder.
fs::path find_file(const std::string& name, const std::vector<fs::path>& folders) {
  std::string searched;
  for (const fs::path& folder : folders) {
    std::error_code error;
    const fs::path root = fs::canonical(folder, error);
    const fs::path file = error ? fs::path() : fs::canonical(root / (name + ".so"), error);
    searched += (searched.empty() ? "" : ", ") + folder.string();
    if (error) continue;
    if (file.parent_path() != root)
      throw Error("'" + (root / (name + ".so")).string() + "' leads out of its folder");
    if (!fs::is_regular_file(file)) throw Error("'" + file.string() + "' is not a regular file");
    refuse_if_anybody_may_write(root);
    refuse_if_anybody_may_write(file);
    return file;
  }
  throw Error("there is no plug-in '" + name + "'" +
              (searched.empty() ? "; no folder of plug-ins is known: name one by --plugins"
                                : "; looked for " + name + ".so in " + searched));
}

std::string last_dl_error() {
  const char* text = ::dlerror();
  return text ? text : "no reason given";
}

// Loads the library and checks its version and its C++ library before anything else of it is used.
const Manifest* manifest_of(const fs::path& file) {
  // RTLD_LOCAL: two plug-ins may have functions of the same name. Never closed, because vtables and texts of
  // exceptions are used until the end.
  void* library = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (!library) throw Error("cannot be loaded: " + last_dl_error());
  const auto entry = reinterpret_cast<const Manifest* (*)()>(::dlsym(library, kEntryName));
  if (!entry)
    throw Error("'" + file.string() + "' is no plug-in: it has no " + std::string(kEntryName) + "()");
  const Manifest* manifest = entry();
  if (!manifest) throw Error("'" + file.string() + "' gives no manifest");
  if (manifest->abi != kAbi)
    throw Error("'" + file.string() + "' was built for version " + std::to_string(manifest->abi) +
                " of plugin.h, this program has version " + std::to_string(kAbi));
  if (std::string_view(manifest->runtime) != kRuntime)
    throw Error("'" + file.string() + "' was built with " + manifest->runtime + ", this program with " +
                kRuntime);
  return manifest;
}

template <typename Kinds>
void check_rows(const fs::path& file, const Kinds& kinds) {
  for (const auto& kind : kinds)
    if (!kind.name || !*kind.name || !kind.make)
      throw Error("'" + file.string() + "' lists a kind without a name, or without a way to make it");
}

template <typename Kind>
const Kind* find_in(const std::vector<Library>& libraries, std::span<const Kind> Manifest::*kinds,
                    const std::string& name) {
  for (const Library& library : libraries)
    for (const Kind& kind : library.manifest->*kinds)
      if (name == kind.name) return &kind;
  return nullptr;
}

}  // namespace

Library open_library(const std::string& name, const std::vector<fs::path>& folders) {
  check_name(name);
  Library library{name, find_file(name, folders), nullptr};
  library.manifest = manifest_of(library.file);
  check_rows(library.file, library.manifest->agents);
  check_rows(library.file, library.manifest->sensors);
  check_rows(library.file, library.manifest->parts);
  check_rows(library.file, library.manifest->engines);
  return library;
}

fs::path find_plugin_folder() {
  std::error_code error;
  const fs::path bin = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (error) return {};
  for (const fs::path& folder : {bin / "../lib/visum/plugins", bin / "../plugins"})
    if (fs::is_directory(folder, error)) return fs::weakly_canonical(folder, error);
  return {};
}

std::vector<fs::path> plugin_folders(const std::vector<std::string>& named) {
  std::vector<fs::path> folders(named.begin(), named.end());
  if (const auto own = find_plugin_folder(); !own.empty()) folders.push_back(own);
  return folders;
}

const AgentKind* find_agent(const std::vector<Library>& libraries, const std::string& kind) {
  return find_in(libraries, &Manifest::agents, kind);
}
const SensorKind* find_sensor(const std::vector<Library>& libraries, const std::string& kind) {
  return find_in(libraries, &Manifest::sensors, kind);
}
const PartKind* find_part(const std::vector<Library>& libraries, const std::string& kind) {
  return find_in(libraries, &Manifest::parts, kind);
}
const EngineKind* find_engine(const std::vector<Library>& libraries, const std::string& kind) {
  return find_in(libraries, &Manifest::engines, kind);
}

}  // namespace visum::plugin

// Finds and opens plug-ins: shared libraries with code that runs in this process with all its rights. So they
// come from folders that an operator named, or from the installed one, and a scene gives no more than a name.
// Once open, a library stays until the process ends. Before the first tick only.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "protocol/plugin/plugin.h"

namespace visum::plugin {

// An open plug-in. Its manifest has been checked.
struct Library {
  std::string name;            // as the scene says it, "explorer"
  std::filesystem::path file;  // "/usr/lib/visum/plugins/explorer.so"
  const Manifest* manifest;
};

// Opens NAME.so from the first of the folders that has it. Throws Error, with what is wrong in words: no such
// file, one that leads out of its folder or that anybody may write, no plug-in, another version.
Library open_library(const std::string& name, const std::vector<std::filesystem::path>& folders);

// Beside this program: installed (../lib/visum/plugins) or in the build tree (../plugins). Empty: in neither.
std::filesystem::path find_plugin_folder();

// The folders that were named, then the one of find_plugin_folder().
std::vector<std::filesystem::path> plugin_folders(const std::vector<std::string>& named);

// Every kind of all libraries, for lookups by name; null: none has it.
const AgentKind* find_agent(const std::vector<Library>& libraries, const std::string& kind);
const SensorKind* find_sensor(const std::vector<Library>& libraries, const std::string& kind);
const PartKind* find_part(const std::vector<Library>& libraries, const std::string& kind);
const EngineKind* find_engine(const std::vector<Library>& libraries, const std::string& kind);

inline constexpr std::size_t kMaxLibraries = 64;

}  // namespace visum::plugin

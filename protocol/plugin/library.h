// Finds and opens plug-ins: shared libraries whose code runs in this process with all its rights. So they
// come only from folders that an operator named, or from the installed folder; a scene gives only a name. An
// open library stays loaded until the process ends. Used before the first tick only.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "protocol/plugin/plugin.h"

namespace visum::plugin {

// An open plug-in, with a checked manifest.
struct Library {
  std::string name;            // as in the scene, "explorer"
  std::filesystem::path file;  // "/usr/lib/visum/plugins/explorer.so"
  const Manifest* manifest;
};

// Opens NAME.so from the first of the folders that has it. Throws Error that says what is wrong: there is no
// such file, it leads out of its folder, anybody may write it, it is no plug-in, or it has another version.
Library open_library(const std::string& name, const std::vector<std::filesystem::path>& folders);

// The folder beside this program: installed (../lib/visum/plugins) or in the build tree (../plugins). Empty
// if neither exists.
std::filesystem::path find_plugin_folder();

// The named folders, then that of find_plugin_folder().
std::vector<std::filesystem::path> plugin_folders(const std::vector<std::string>& named);

// Finds a kind by name in all libraries. Null: no library has it.
const AgentKind* find_agent(const std::vector<Library>& libraries, const std::string& kind);
const SensorKind* find_sensor(const std::vector<Library>& libraries, const std::string& kind);
const PartKind* find_part(const std::vector<Library>& libraries, const std::string& kind);
const EngineKind* find_engine(const std::vector<Library>& libraries, const std::string& kind);

inline constexpr std::size_t kMaxLibraries = 64;

}  // namespace visum::plugin

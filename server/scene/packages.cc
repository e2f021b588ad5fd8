#include "server/scene/packages.h"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "protocol/config/read_file.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;
using config::is_file;

constexpr std::size_t kMaxManifestBytes = 1u << 20;

// Appends the folders of a variable such as PATH, each with `below` behind it.
void add_folders(const char* variable, const char* below, std::vector<fs::path>& folders) {
  const char* value = std::getenv(variable);
  std::istringstream list(value ? value : "");
  for (std::string folder; std::getline(list, folder, ':');)
    if (!folder.empty()) folders.push_back(fs::path(folder) / below);
}

// True if the folder's package.xml gives the package this name.
bool is_package(const fs::path& folder, const std::string& name) {
  const fs::path manifest = folder / "package.xml";
  if (!is_file(manifest)) return false;
  const auto content = config::read_file(manifest, kMaxManifestBytes);
  return content.fault.empty() && content.bytes.find("<name>" + name + "</name>") != std::string::npos;
}

}  // namespace

Packages with_environment(Packages packages) {
  add_folders("ROS_PACKAGE_PATH", "", packages.folders);
  add_folders("AMENT_PREFIX_PATH", "share", packages.folders);
  add_folders("GZ_SIM_RESOURCE_PATH", "", packages.folders);
  add_folders("GAZEBO_MODEL_PATH", "", packages.folders);
  add_folders("SDF_PATH", "", packages.folders);
  return packages;
}

fs::path find_in_package(const std::string& name_and_rest, const fs::path& model_file,
                         const Packages& packages) {
  return find_in_package(name_and_rest, model_file, packages,
                         [](const fs::path& file) { return is_file(file) ? file : fs::path(); });
}

fs::path find_in_package(const std::string& written, const fs::path& model_file, const Packages& packages,
                         const AcceptPath& accept) {
  const std::string name_and_rest = written.substr(std::min(written.find_first_not_of('/'), written.size()));
  const std::size_t slash = name_and_rest.find('/');
  const std::string name = name_and_rest.substr(0, slash);
  const fs::path rest = slash == std::string::npos ? fs::path() : fs::path(name_and_rest.substr(slash + 1));
  if (const auto given = packages.given.find(name); given != packages.given.end())
    return accept(given->second / rest);
  for (fs::path folder = fs::absolute(model_file).lexically_normal().parent_path();;
       folder = folder.parent_path()) {
    if (const fs::path found = accept(folder / name_and_rest); !found.empty()) return found;
    if (is_package(folder, name))
      if (const fs::path found = accept(folder / rest); !found.empty()) return found;
    if (folder == folder.parent_path()) break;
  }
  for (const fs::path& folder : packages.folders) {
    if (const fs::path found = accept(folder / name_and_rest); !found.empty()) return found;
    if (folder.filename() == name)
      if (const fs::path found = accept(folder / rest); !found.empty()) return found;
  }
  return {};
}

}  // namespace visum::scene

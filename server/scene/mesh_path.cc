#include "server/scene/mesh_path.h"

#include <optional>

#include "protocol/config/read_file.h"

namespace visum::scene {
namespace {

namespace fs = std::filesystem;
using config::is_file;

std::optional<std::string> without_scheme(const std::string& uri, const std::string& scheme) {
  const std::string prefix = scheme + "://";
  if (uri.compare(0, prefix.size(), prefix) != 0) return std::nullopt;
  return uri.substr(prefix.size());
}

// Finds "robot/meshes/arm.stl". A package is a folder of that name; the model may lie in it or beside it.
std::optional<fs::path> find_in_package(const std::string& name_and_rest, const fs::path& model_file) {
  fs::path folder = fs::absolute(model_file).lexically_normal().parent_path();
  while (true) {
    if (is_file(folder / name_and_rest)) return folder / name_and_rest;
    if (folder == folder.parent_path()) return std::nullopt;
    folder = folder.parent_path();
  }
}

}  // namespace

fs::path resolve_mesh(const std::string& uri, const fs::path& model_file, const config::Place& wanted_by) {
  auto packaged = without_scheme(uri, "package");
  if (!packaged) packaged = without_scheme(uri, "model");
  if (packaged) {
    if (const auto found = find_in_package(*packaged, model_file)) return *found;
    throw config::ConfigError(wanted_by, "mesh '" + uri + "': no such file in the folders above the model");
  }
  const std::string path = without_scheme(uri, "file").value_or(uri);
  if (path.find("://") != std::string::npos)
    throw config::ConfigError(wanted_by, "mesh '" + uri + "': addresses are not followed, name a file");
  const fs::path file = (model_file.parent_path() / path).lexically_normal();
  if (!is_file(file))
    throw config::ConfigError(wanted_by, "mesh '" + uri + "': no such file ('" + file.string() + "')");
  return file;
}

}  // namespace visum::scene

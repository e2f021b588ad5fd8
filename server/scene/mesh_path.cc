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

}  // namespace

fs::path resolve_mesh(const std::string& uri, const fs::path& model_file, const Packages& packages,
                      const config::Place& wanted_by) {
  auto packaged = without_scheme(uri, "package");
  if (!packaged) packaged = without_scheme(uri, "model");
  if (packaged) {
    if (const auto found = find_in_package(*packaged, model_file, packages); !found.empty()) return found;
    throw config::ConfigError(wanted_by, "mesh '" + uri +
                                             "': no such file in the folders above the model; name its "
                                             "package's folder with --package NAME=PATH");
  }
  const std::string path = without_scheme(uri, "file").value_or(uri);
  if (path.find("://") != std::string::npos)
    throw config::ConfigError(wanted_by, "mesh '" + uri + "': addresses are not followed, name a file");
  fs::path file = (model_file.parent_path() / path).lexically_normal();
  // "/meshes/arm.stl" may mean the folder of the model.
  if (fs::path(path).is_absolute() && !is_file(file))
    if (const fs::path beside =
            (model_file.parent_path() / fs::path(path).relative_path()).lexically_normal();
        is_file(beside))
      file = beside;
  if (!is_file(file))
    throw config::ConfigError(wanted_by, "mesh '" + uri + "': no such file ('" + file.string() + "')");
  return file;
}

}  // namespace visum::scene

#include "server/gateway/scene_files.h"

#include <algorithm>
#include <string_view>

#include "server/gateway/model_files.h"
#include "server/scene/bare_model.h"
#include "server/scene/convert/convert.h"

namespace visum::gateway {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kYaml = ".yaml";

bool is_yaml(const fs::path& file) {
  return file.extension() == kYaml;
}

bool is_scene(const fs::path& file) {
  return is_yaml(file) || scene::is_model_file(file) || scene::is_x3d_file(file);
}

std::vector<std::string> names_in(const fs::path& folder, bool (*is_one)(const fs::path& file)) {
  auto names = files_in(folder, is_one);
  for (auto& name : names)
    if (name.ends_with(kYaml)) name.resize(name.size() - kYaml.size());
  std::ranges::sort(names);
  return names;
}

}  // namespace

std::vector<std::string> scenes_in(const fs::path& models) {
  return names_in(models / "scenes", &is_scene);
}

fs::path scene_file(const fs::path& models, const std::string& name) {
  const fs::path file = models / "scenes" / name;
  return is_scene(file) ? file : fs::path(file.string() + std::string(kYaml));
}

}  // namespace visum::gateway

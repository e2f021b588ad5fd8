#include "server/gateway/scenario_files.h"

#include <algorithm>
#include <system_error>

#include "server/gateway/plain_name.h"

namespace visum::gateway {

namespace fs = std::filesystem;

std::vector<std::string> scenarios_in(const fs::path& models) {
  std::vector<std::string> names;
  std::error_code error, none;
  fs::directory_iterator at(models / "scenarios", error);
  for (; !error && at != fs::directory_iterator() && names.size() < kMostScenarios; at.increment(error))
    if (at->path().extension() == ".yaml" && at->is_regular_file(none) &&
        is_plain_name(at->path().stem().string()))
      names.push_back(at->path().stem().string());
  std::ranges::sort(names);
  return names;
}

fs::path scenario_file(const fs::path& models, const std::string& name) {
  if (models.empty() || !is_plain_name(name)) return {};
  std::error_code error;
  const fs::path file = models / "scenarios" / (name + ".yaml");
  return fs::is_regular_file(file, error) ? file : fs::path();
}

fs::path scenario_program() {
  std::error_code error;
  return fs::read_symlink("/proc/self/exe", error).parent_path() / "visum";
}

}  // namespace visum::gateway

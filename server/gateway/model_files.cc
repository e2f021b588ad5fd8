#include "server/gateway/model_files.h"

#include <algorithm>
#include <sstream>
#include <system_error>
#include <utility>

#include "server/scene/bare_model.h"

namespace visum::gateway {
namespace {

namespace fs = std::filesystem;

constexpr int kDeepest = 4;
constexpr std::size_t kMostBytes = std::size_t{256} << 10;  // of a scene file that is looked at
constexpr std::size_t kMostEntries = 100'000;

using protocol::kMostPathBytes;
using protocol::kMostSentBytes;
using protocol::kMostSentFiles;

// True for a file of the scene format with a parameter `name`, found without parsing: what is wrong with it
// is told to whoever spawns it.
bool has_parameter_name(const fs::path& file) {
  std::istringstream lines(config::read_file(file, kMostBytes).bytes);
  bool within = false;
  for (std::string line; std::getline(lines, line);) {
    const auto first = line.find_first_not_of(' ');
    if (first == std::string::npos || line[first] == '#') continue;
    if (first == 0) within = line.starts_with("parameters:");
    if (within && first > 0 && line.compare(first, 5, "name:") == 0) return true;
  }
  return false;
}

bool is_model(const fs::path& file) {
  return scene::is_model_file(file) || (file.extension() == ".yaml" && has_parameter_name(file));
}

// A path that stays where it is put: relative, in its shortest form, and not above its beginning.
bool stays_below(const std::string& path) {
  const fs::path as_path(path);
  return !path.empty() && path.size() <= kMostPathBytes && as_path.is_relative() &&
         as_path.lexically_normal().string() == path && *as_path.begin() != ".." && path != "." &&
         path.find('\0') == std::string::npos && !path.ends_with('/');
}

}  // namespace

std::vector<std::string> files_in(const fs::path& folder, bool (*is_one)(const fs::path& file)) {
  std::vector<std::string> found;
  std::error_code error;
  fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error);
  for (std::size_t seen = 0; !error && at != fs::recursive_directory_iterator() && seen < kMostEntries;
       at.increment(error), ++seen) {
    if (at.depth() >= kDeepest) at.disable_recursion_pending();
    std::error_code none;
    if (found.size() < kMostListed && at->is_regular_file(none) && is_one(at->path()))
      found.push_back(at->path().lexically_relative(folder).string());
  }
  std::ranges::sort(found);
  return found;
}

std::vector<std::string> models_in(const fs::path& folder) {
  return files_in(folder, &is_model);
}

fs::path find_models_folder() {
  std::error_code error;
  const fs::path bin = fs::read_symlink("/proc/self/exe", error).parent_path();
  if (error) return {};
  for (const fs::path& folder : {bin / "../share/visum/models", bin / "../../../models"})
    if (fs::is_directory(folder, error)) return fs::weakly_canonical(folder, error);
  return {};
}

std::string fault_of_files(const protocol::SpawnModel& request) {
  if (request.files.size() > kMostSentFiles)
    return "a model has at most " + std::to_string(kMostSentFiles) + " files";
  std::size_t bytes = 0;
  bool found = false;
  for (const auto& file : request.files) {
    if (!stays_below(file.path))
      return "'" + file.path +
             "' is no path of a model's file: it must be relative, without '.' and '..', and " +
             "have at most " + std::to_string(kMostPathBytes) + " bytes";
    bytes += file.path.size() + file.content.size();
    found = found || file.path == request.file;
  }
  if (bytes > kMostSentBytes)
    return "the files of a model have at most " + std::to_string(kMostSentBytes) + " bytes, these have " +
           std::to_string(bytes);
  return found ? "" : "'" + request.file + "' is not among the files that were sent";
}

fs::path sent_folder() {
  return "/sent";
}

config::Files files_of(std::vector<protocol::ModelFile> sent) {
  config::Files files;
  for (auto& file : sent) files[(sent_folder() / file.path).string()] = std::move(file.content);
  return files;
}

}  // namespace visum::gateway

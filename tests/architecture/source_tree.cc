#include "tests/architecture/source_tree.h"

#include <algorithm>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

namespace visum::architecture {
namespace fs = std::filesystem;
namespace {

// Extensions of the text files that people write here. Files without an extension are scripts.
const std::set<std::string> kTextExtensions = {
    "",      ".h",    ".c",   ".cc", ".py",  ".sh", ".cmake", ".txt",  ".proto", ".md",   ".yaml",   ".yml",
    ".json", ".urdf", ".sdf", ".js", ".mjs", ".ts", ".css",   ".html", ".in",    ".toml", ".service"};
const std::set<std::string> kSkippedFolders = {"build", "__pycache__", "node_modules"};

bool is_skipped_folder(const fs::path& path) {
  const std::string name = path.filename().string();
  return name.starts_with('.') || kSkippedFolders.contains(name) || name.ends_with(".egg-info");
}

std::string read_text(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

std::vector<Include> find_includes(const std::vector<std::string>& lines) {
  static const std::regex pattern(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
  std::vector<Include> found;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::smatch match;
    if (std::regex_search(lines[i], match, pattern))
      found.push_back({match[2], match[1] == "<", static_cast<int>(i) + 1});
  }
  return found;
}

}  // namespace

std::string folder_of(const std::string& path) {
  const auto slash = path.rfind('/');
  return slash == std::string::npos ? "" : path.substr(0, slash);
}

std::string extension_of(const std::string& path) {
  return fs::path(path).extension().string();
}

bool is_header(const std::string& path) {
  return path.ends_with(".h");
}

bool is_cpp(const std::string& path) {
  return is_header(path) || path.ends_with(".cc");
}

bool starts_with_folder(const std::string& path, const std::string& folder) {
  return path == folder || path.starts_with(folder + "/");
}

SourceFile make_file(const std::string& path, const std::string& text) {
  SourceFile file{path, {}, {}};
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) file.lines.push_back(line);
  if (is_cpp(path)) file.includes = find_includes(file.lines);
  return file;
}

SourceTree read_tree(const fs::path& root) {
  SourceTree tree;
  for (const auto& entry : fs::directory_iterator(root))
    tree.top_level.push_back(entry.path().filename().string());
  std::sort(tree.top_level.begin(), tree.top_level.end());
  for (auto it = fs::recursive_directory_iterator(root); it != fs::recursive_directory_iterator(); ++it) {
    if (it->is_directory() && is_skipped_folder(it->path())) it.disable_recursion_pending();
    if (!it->is_regular_file() || !kTextExtensions.contains(it->path().extension().string())) continue;
    const std::string path = fs::relative(it->path(), root).generic_string();
    tree.files.emplace(path, make_file(path, read_text(it->path())));
  }
  return tree;
}

}  // namespace visum::architecture

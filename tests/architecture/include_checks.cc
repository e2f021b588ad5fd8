#include <algorithm>
#include <functional>
#include <set>

#include "tests/architecture/checks.h"
#include "tests/architecture/rules.h"

namespace visum::architecture {
namespace {

using Graph = std::map<std::string, std::set<std::string>>;

std::string at(const SourceFile& file, int line) {
  return file.path + ":" + std::to_string(line) + ": ";
}

bool is_generated(const std::string& target) {
  return target.ends_with(".pb.h");
}

// Returns the row with the longest folder that holds the path, or null if no row does.
const Layer* layer_of(const std::string& path) {
  const Layer* best = nullptr;
  for (const Layer& layer : layers())
    if (starts_with_folder(path, layer.folder) && (!best || layer.folder.size() > best->folder.size()))
      best = &layer;
  return best;
}

bool may_include(const Layer& from, const std::string& target) {
  const Layer* to = layer_of(target);
  if (to == &from) return true;
  return std::any_of(from.may_use.begin(), from.may_use.end(),
                     [&](const auto& allowed) { return starts_with_folder(target, allowed); });
}

// Returns each cycle that a depth-first walk of the graph closes, as "a -> b -> a".
Findings find_cycles(const Graph& graph, const std::string& what) {
  Findings found;
  std::set<std::string> done;
  std::vector<std::string> path;
  std::function<void(const std::string&)> visit = [&](const std::string& node) {
    const auto on_path = std::find(path.begin(), path.end(), node);
    if (on_path != path.end()) {
      std::string cycle = what + " include each other: ";
      for (auto it = on_path; it != path.end(); ++it) cycle += *it + " -> ";
      found.push_back(cycle + node);
      return;
    }
    if (done.contains(node)) return;
    path.push_back(node);
    if (const auto edges = graph.find(node); edges != graph.end())
      for (const auto& next : edges->second) visit(next);
    path.pop_back();
    done.insert(node);
  };
  for (const auto& [node, edges] : graph) visit(node);
  return found;
}

const ThirdParty* third_party_of(const std::string& target) {
  for (const ThirdParty& row : third_parties())
    if (target.starts_with(row.prefix)) return &row;
  return nullptr;
}

bool is_place_of(const ThirdParty& row, const std::string& path) {
  return std::any_of(row.places.begin(), row.places.end(),
                     [&](const auto& place) { return starts_with_folder(path, place); });
}

// Returns `path` and all files of the tree that it includes, over any number of steps.
std::set<std::string> reachable(const SourceTree& tree, const std::string& path) {
  std::set<std::string> seen;
  std::vector<std::string> open{path};
  while (!open.empty()) {
    const std::string current = open.back();
    open.pop_back();
    const auto file = tree.files.find(current);
    if (file == tree.files.end() || !seen.insert(current).second) continue;
    for (const Include& include : file->second.includes) open.push_back(include.target);
  }
  return seen;
}

}  // namespace

Findings check_includes_resolve(const SourceTree& tree) {
  Findings found;
  for (const auto& [path, file] : tree.files)
    for (const Include& include : file.includes)
      if (!include.angled && !is_generated(include.target) && !tree.files.contains(include.target))
        found.push_back(at(file, include.line) + "\"" + include.target + "\" is no file, seen from the root");
  return found;
}

Findings check_layers(const SourceTree& tree) {
  Findings found;
  for (const auto& [path, file] : tree.files) {
    const Layer* from = layer_of(path);
    if (!is_cpp(path)) continue;
    if (!from) found.push_back(path + ": stands in no folder of the table in tests/architecture/rules.cc");
    for (const Include& include : file.includes) {
      if (!from || include.angled || is_generated(include.target) || !layer_of(include.target)) continue;
      if (!may_include(*from, include.target))
        found.push_back(at(file, include.line) + from->folder + " must not include \"" + include.target +
                        "\"");
    }
  }
  return found;
}

Findings check_folder_cycles(const SourceTree& tree) {
  Graph graph;
  for (const auto& [path, file] : tree.files) {
    for (const Include& include : file.includes)
      if (tree.files.contains(include.target) && folder_of(include.target) != folder_of(path))
        graph[folder_of(path)].insert(folder_of(include.target));
  }
  return find_cycles(graph, "folders");
}

Findings check_file_cycles(const SourceTree& tree) {
  Graph graph;
  for (const auto& [path, file] : tree.files)
    for (const Include& include : file.includes)
      if (tree.files.contains(include.target)) graph[path].insert(include.target);
  return find_cycles(graph, "files");
}

Findings check_third_parties(const SourceTree& tree) {
  Findings found;
  for (const auto& [path, file] : tree.files) {
    for (const auto& reached : reachable(tree, path)) {
      for (const Include& include : tree.files.at(reached).includes) {
        if (tree.files.contains(include.target)) continue;
        const ThirdParty* row = third_party_of(include.target);
        const std::string through = reached == path ? "" : " (through " + reached + ")";
        if (row && !is_place_of(*row, path))
          found.push_back(path + ": must not see <" + include.target + ">" + through);
        if (!row && include.angled && !is_system_header(include.target) && reached == path)
          found.push_back(at(file, include.line) + "<" + include.target +
                          "> is in no table of tests/architecture/rules.cc");
      }
    }
  }
  return found;
}

}  // namespace visum::architecture

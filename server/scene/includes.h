// Files that include others: finds the included file, its parameters and its place, and bounds their number.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "protocol/config/expand.h"
#include "server/scene/draft.h"

namespace visum::scene {

inline constexpr std::size_t kMaxIncludeDepth = 16;
// A bound, because files that each include others twice double their number at every level.
inline constexpr std::size_t kMaxIncludes = 4096;
inline constexpr std::size_t kMaxParameters = 256;  // of one file

// An entry of `include:`, a file name or {file, parameters, pose}.
struct IncludeEntry {
  std::filesystem::path file;
  std::optional<config::Node> parameters;
  std::optional<world::Pose> X_WO;  // as Draft::X_WO, for the included file
};
IncludeEntry read_include(const Draft& draft, const config::Node& entry);

// The values of a file's parameters: those of `given`, and the file's own defaults for the rest. `asked_by`
// is the entry that includes the file, which gets the blame for a missing value; null for the first file.
config::Variables read_parameters(const config::Node& root, const std::optional<config::Node>& given,
                                  const config::Node* asked_by, config::ExpansionBudget& budget);

// If the error is in `file` itself, adds the entry that includes it. Other errors are returned unchanged.
config::ConfigError told_where(const config::ConfigError& error, const std::filesystem::path& file,
                               const config::Node& entry);

// The chain of files that are being read, each included by the one before, and the text of every file that
// was read. Lives as long as the scene is being read.
class Includes {
 public:
  // Throws ConfigError at `entry` for a circle, too many levels, too many files, or a missing file.
  void check(const std::filesystem::path& file, const config::Node& entry) const;
  // Opens a file and adds it to the chain. Its text is read once, however often it is included.
  config::Node open(const std::filesystem::path& file);
  // Removes the last file from the chain.
  void close() { chain_.pop_back(); }

 private:
  std::vector<std::filesystem::path> chain_;
  std::map<std::filesystem::path, config::Node> texts_;
  std::size_t opened_ = 0;
};

}  // namespace visum::scene

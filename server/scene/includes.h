// Files that include others: which file is meant, with what values and where; and that it comes to an end.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "protocol/config/expand.h"
#include "server/scene/draft.h"

namespace visum::scene {

inline constexpr std::size_t kMaxIncludeDepth = 16;
inline constexpr std::size_t kMaxIncludes =
    4096;  // files that include others twice each double at every level
inline constexpr std::size_t kMaxParameters = 256;  // of one file

// One entry of `include:`, a file name or {file, parameters, pose}.
struct IncludeEntry {
  std::filesystem::path file;
  std::optional<config::Node> parameters;
  std::optional<world::Pose> X_WO;  // as Draft::X_WO, for the file
};
IncludeEntry read_include(const Draft& draft, const config::Node& entry);

// The values of a file's parameters: those that `given` names, its own defaults for the rest. `asked_by`: the
// entry that includes the file, to be blamed for what is missing; null for the first file.
config::Variables read_parameters(const config::Node& root, const std::optional<config::Node>& given,
                                  const config::Node* asked_by, config::ExpansionBudget& budget);

// An error in `file` itself, with the entry that led there; others as they are.
config::ConfigError told_where(const config::ConfigError& error, const std::filesystem::path& file,
                               const config::Node& entry);

// The files that are being read, each included by the one before, and the text of all that were.
class Includes {
 public:
  // Fails at `entry` for a circle, too many levels, too many files, or a file that is not there.
  void check(const std::filesystem::path& file, const config::Node& entry) const;
  // Reads each file once, however often it is included.
  config::Node open(const std::filesystem::path& file);
  void close() { chain_.pop_back(); }

 private:
  std::vector<std::filesystem::path> chain_;
  std::map<std::filesystem::path, config::Node> texts_;
  std::size_t opened_ = 0;
};

}  // namespace visum::scene

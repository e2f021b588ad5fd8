// The rules of the house in one place. Change them here, with the reason, or not at all.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace visum::architecture {

// What a file, or the files of a folder (and of those below it that have no row of their own), may include.
// An entry is a folder, which means its own files and those below, or one header. Its own folder is always
// allowed.
struct Layer {
  std::string folder;
  std::vector<std::string> may_use;
};
std::span<const Layer> layers();

// A third-party header, and the only places that may see it, directly or through headers of ours.
struct ThirdParty {
  std::string prefix;               // of what stands between the brackets
  std::vector<std::string> places;  // folders or files; "" is everywhere
};
std::span<const ThirdParty> third_parties();

// Headers of the C library, POSIX and Linux: allowed everywhere, as is every header without a dot (the C++
// library).
bool is_system_header(std::string_view target);

// What may stand in the root; hidden entries have a table of their own.
std::span<const std::string> top_level_entries();
std::span<const std::string> top_level_hidden_entries();
std::span<const std::string> untracked_entries();  // results of tools, in .gitignore

// Folders that must hold C++: an empty one means that the test looked in the wrong place.
std::span<const std::string> folders_with_code();

std::span<const std::string> unfinished_words();

inline constexpr std::size_t kMaxFileLines = 500;
inline constexpr std::size_t kMaxFunctionLines = 120;

// Files that a length limit is for: code, not data and not prose.
bool is_code(std::string_view path);

// models/ is data. Code there makes data, and its name says so.
bool is_model_generator(std::string_view path);

}  // namespace visum::architecture

// All rules of the architecture test in one place. A change of a rule needs a reason beside it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace visum::architecture {

// Names the includes that a file may have, or all files of a folder. A folder's row also holds for folders
// below it that have no row of their own. An entry of may_use is one header, or a folder with all below it.
// Files may always include others of their own folder.
struct Layer {
  std::string folder;
  std::vector<std::string> may_use;
};
std::span<const Layer> layers();

// A third-party header, and the only places that may see it, directly or through headers of ours.
struct ThirdParty {
  std::string prefix;               // of the path between the brackets
  std::vector<std::string> places;  // folders or files; "" is everywhere
};
std::span<const ThirdParty> third_parties();

// Headers of the C library, POSIX and Linux: allowed everywhere, as is every header without a dot (the C++
// library).
bool is_system_header(std::string_view target);

// Files and folders that the root may hold; hidden entries have a table of their own.
std::span<const std::string> top_level_entries();
std::span<const std::string> top_level_hidden_entries();
std::span<const std::string> untracked_entries();  // made by tools, and in .gitignore

// Folders that must hold C++: an empty one means that the test looked in the wrong place.
std::span<const std::string> folders_with_code();

std::span<const std::string> unfinished_words();

inline constexpr std::size_t kMaxFileLines = 460;
inline constexpr std::size_t kMaxFunctionLines = 80;

// Tells whether the limits on lengths hold for the file: they do for code, not for data or prose.
bool is_code(std::string_view path);

// models/ is data. Code there makes data, and its name says so.
bool is_model_generator(std::string_view path);

// Words that a comment may not begin with, unless its first sentence is a question. "What the rotor gained"
// is half a sentence: the reader has to guess its verb.
std::span<const std::string> banned_openings();

// A reader can put two windows side by side with these widths. clang-format wraps C++ at the first one.
inline constexpr std::size_t kMaxCommentColumns = 110;
inline constexpr std::size_t kMaxPageColumns = 100;  // of Markdown; not of code, tables, HTML, addresses

// How comments that end with their line begin in this file: "//" or "#", or "" where we check none.
std::string_view comment_marker(std::string_view path);

}  // namespace visum::architecture

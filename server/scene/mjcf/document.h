// An MJCF document as a plain tree: what its files say, with all includes in their places. It knows lines and
// files, and no meaning. tinyxml2 stays inside document.cc. Pure values; any thread.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/config/config.h"

namespace visum::scene::mjcf {

struct Element {
  std::string tag;
  std::vector<std::pair<std::string, std::string>> attributes;
  std::vector<Element> children;
  std::shared_ptr<const std::string> file;
  int line = 0;

  const std::string* attribute(std::string_view name) const;  // null if it is not there
  std::string name() const;                                   // empty if it has none
  config::Place place() const;
  [[noreturn]] void fail(const std::string& message) const;
};

// Calls `visit` for each child of this tag, in the order of the file.
template <typename Visit>
void each_child(const Element& element, std::string_view tag, const Visit& visit) {
  for (const Element& child : element.children)
    if (child.tag == tag) visit(child);
}

inline constexpr std::size_t kMaxElements = 50'000;
inline constexpr std::size_t kMaxDepth = 200;  // of elements in elements, over all includes
inline constexpr std::size_t kMaxIncludes = 200;
inline constexpr std::size_t kMaxTextBytes = std::size_t{32} << 20;  // of all files together

// Reads `text`, the content of `file`, and the files that it includes. Throws ConfigError with file and line.
Element read_document(const std::filesystem::path& file, const std::string& text);

}  // namespace visum::scene::mjcf

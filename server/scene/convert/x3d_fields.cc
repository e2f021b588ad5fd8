#include <algorithm>
#include <array>
#include <string_view>

#include "server/scene/convert/x3d_node.h"

namespace visum::scene {
namespace {

constexpr std::array<std::string_view, 4> kTexts{"name", "title", "description", "reference"};
// `value` of metadata holds texts in MetadataString and numbers in the others; the writer looks at the
// content.
constexpr std::array<std::string_view, 4> kManyTexts{"info", "type", "forceOutput", "url"};
constexpr std::array<std::string_view, 8> kMany{"children",   "bodies", "joints", "point",
                                                "coordIndex", "index",  "value",  "collidables"};

template <typename List>
bool holds(const List& list, const std::string& field) {
  return std::find(list.begin(), list.end(), field) != list.end();
}

}  // namespace

bool is_text_field(const std::string& field) {
  return holds(kTexts, field);
}
bool is_texts_field(const std::string& field) {
  return holds(kManyTexts, field);
}
bool is_many_field(const std::string& field) {
  return holds(kMany, field);
}

}  // namespace visum::scene

// Names of files that clients ask for: no path can be made of them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string_view>

namespace visum::gateway {

inline constexpr std::size_t kMostNameBytes = 64;
inline constexpr const char* kPlainNameRule =
    "a name begins with a letter; letters, digits, '_' and '-' follow, 64 bytes in all";

constexpr bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

constexpr bool is_plain_name(std::string_view name) {
  return !name.empty() && name.size() <= kMostNameBytes && is_letter(name.front()) &&
         std::ranges::all_of(
             name, [](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-'; });
}

}  // namespace visum::gateway

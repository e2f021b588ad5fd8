// Makes any text safe for formats that must be UTF-8.
#pragma once

#include <string>
#include <string_view>

namespace visum::cli {

// Bytes that are not UTF-8 become '?'.
std::string valid_utf8(std::string_view text);

}  // namespace visum::cli

// Text from elsewhere inside XML and HTML.
#pragma once

#include <string>

namespace visum::cli {

// For content and for attributes in double quotes. Bytes that are no UTF-8, and control characters, which XML
// 1.0 cannot write, become '?'.
std::string markup(const std::string& text);

}  // namespace visum::cli

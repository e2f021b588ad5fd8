// Makes any text safe inside XML and HTML.
#pragma once

#include <string>

namespace visum::cli {

// For content and for attributes in double quotes. Bytes that are not UTF-8 become '?', and so do control
// characters, which XML 1.0 cannot hold.
std::string markup(const std::string& text);

}  // namespace visum::cli

// Text that may be shown in a terminal or a line of a log. Names come from files, clients and certificates,
// and must not move the cursor, begin another line or turn round what follows them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace visum::config {

// The bytes of the well-formed UTF-8 sequence that begins at `at`; 0: there is none.
std::size_t utf8_length(std::string_view text, std::size_t at);

// True for UTF-8 without controls (C0, DEL, C1), line and paragraph separators, and the marks that change the
// direction of text (U+061C, U+200E, U+200F, U+202A to U+202E, U+2066 to U+2069).
bool is_printable(std::string_view text);

// The text with everything else escaped: \x1b for a byte, \u202e for a character. `kept`: controls that stay
// as they are, such as "\t".
std::string printable(std::string_view text, std::string_view kept = {});

// At most so many bytes of the text, which is cut between two characters.
std::string shortened(std::string text, std::size_t most);

// The end of a refusal: "client_name must not ...".
inline constexpr const char* kNotPrintable =
    "must not hold control characters, separators of lines, or marks of direction";

}  // namespace visum::config

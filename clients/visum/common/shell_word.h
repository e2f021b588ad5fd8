// Words for a command line that a shell reads.
#pragma once

#include <string>

namespace visum::cli {

// In quotes where it needs them: "it's" becomes 'it'\''s'.
std::string shell_word(const std::string& word);

}  // namespace visum::cli

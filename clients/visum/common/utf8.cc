#include "clients/visum/common/utf8.h"

#include "protocol/config/printable.h"

namespace visum::cli {
std::string valid_utf8(std::string_view text) {
  std::string valid;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = config::utf8_length(text, i);
    valid += length == 0 ? std::string("?") : std::string(text.substr(i, length));
    i += length == 0 ? 1 : length;
  }
  return valid;
}

}  // namespace visum::cli

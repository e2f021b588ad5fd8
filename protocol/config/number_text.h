// Numbers in messages for people. Pure function, any thread.
#pragma once

#include <charconv>
#include <string>

namespace visum::config {

// The shortest form that reads back as the same number: 0.1, not 0.100000 or 0.10000000000000001.
inline std::string number_text(double number) {
  char buffer[32];
  const auto end = std::to_chars(buffer, buffer + sizeof buffer, number).ptr;
  return std::string(buffer, end);
}

}  // namespace visum::config

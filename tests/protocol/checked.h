// Turns a failed system call into an exception.
#pragma once

#include <cerrno>
#include <system_error>

namespace visum::testing {

inline int checked(int result, const char* what) {
  if (result < 0) throw std::system_error(errno, std::generic_category(), what);
  return result;
}

}  // namespace visum::testing

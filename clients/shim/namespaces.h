// Tells process namespaces apart: in another one a process has another number than its parent sees. Any
// thread. Source: namespaces(7), "The /proc/pid/ns/ directory".
#pragma once

#include <sys/stat.h>

#include <cstdint>

namespace visum::shim {

// Returns the number of the calling process's namespace; 0: /proc does not tell.
inline std::uint64_t pid_namespace() {
  struct stat status {};
  return ::stat("/proc/self/ns/pid", &status) == 0 ? status.st_ino : 0;
}

}  // namespace visum::shim

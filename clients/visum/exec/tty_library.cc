#include "clients/visum/exec/tty_library.h"

#include <sys/stat.h>

#include <cstdio>
#include <string>

#include "clients/visum/exec/preload.h"

namespace visum::exec {
void load_tty_library(const std::vector<Placement>& placements) {
  const auto library = own_library("visum-tty", "libvisum-tty.so");
  // This process may become the program; no one would remove a link then.
  if (!is_preloadable(library)) {
    std::fprintf(stderr,
                 "visum: the loader cannot preload %s, whose path holds a space or a colon: what the program "
                 "writes just before it discards its output (tcflush) may be lost\n",
                 library.c_str());
    return;
  }
  append_to_variable("LD_PRELOAD", library.string(), ':');
  for (const auto& placement : placements) {
    struct stat status {};
    if (::stat(placement.source.c_str(), &status) != 0) continue;  // place_devices() reports it
    append_to_variable("VISUM_TTYS", std::to_string(status.st_rdev), ',');
  }
}

}  // namespace visum::exec

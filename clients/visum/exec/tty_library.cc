#include "clients/visum/exec/tty_library.h"

#include <sys/stat.h>

#include <string>

#include "clients/visum/exec/preload.h"

namespace visum::exec {
void load_tty_library(const std::vector<Placement>& placements) {
  preload("visum-tty", "libvisum-tty.so");
  for (const auto& placement : placements) {
    struct stat status {};
    if (::stat(placement.source.c_str(), &status) != 0) continue;  // place_devices() says so
    append_to_variable("VISUM_TTYS", std::to_string(status.st_rdev), ',');
  }
}

}  // namespace visum::exec

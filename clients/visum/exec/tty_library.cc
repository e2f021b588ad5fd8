#include "clients/visum/exec/tty_library.h"

#include <sys/stat.h>

#include <cstdlib>
#include <filesystem>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/run/daemon.h"

namespace visum::exec {
namespace {

// `value` behind what the variable holds already.
void append(const char* variable, const std::string& value, char separator) {
  const char* before = std::getenv(variable);
  const auto all = before && *before ? std::string(before) + separator + value : value;
  ::setenv(variable, all.c_str(), 1);
}

}  // namespace

void load_tty_library(const std::vector<Placement>& placements) {
  const auto library = run::own_folder().parent_path() / "lib" / "visum-tty" / "libvisum-tty.so";
  if (!std::filesystem::exists(library))
    throw cli::ExitError(cli::kFailed, "there is no " + library.string());
  append("LD_PRELOAD", library.string(), ':');
  for (const auto& placement : placements) {
    struct stat status {};
    if (::stat(placement.source.c_str(), &status) != 0) continue;  // place_devices() says so
    append("VISUM_TTYS", std::to_string(status.st_rdev), ',');
  }
}

}  // namespace visum::exec

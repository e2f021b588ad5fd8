#include "clients/visum/exec/preload.h"

#include <cstdlib>
#include <filesystem>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/run/daemon.h"

namespace visum::exec {

void append_to_variable(const char* variable, const std::string& value, char separator) {
  const char* before = std::getenv(variable);
  const auto all = before && *before ? std::string(before) + separator + value : value;
  ::setenv(variable, all.c_str(), 1);
}

void preload(const std::string& folder, const std::string& name) {
  const auto library = run::own_folder().parent_path() / "lib" / folder / name;
  if (!std::filesystem::exists(library))
    throw cli::ExitError(cli::kFailed, "there is no " + library.string());
  append_to_variable("LD_PRELOAD", library.string(), ':');
}

}  // namespace visum::exec

#include "clients/visum/exec/preload.h"

#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "clients/visum/common/exit_code.h"
#include "clients/visum/run/daemon.h"

namespace visum::exec {

void append_to_variable(const char* variable, const std::string& value, char separator) {
  const char* before = std::getenv(variable);
  const auto all = before && *before ? std::string(before) + separator + value : value;
  ::setenv(variable, all.c_str(), 1);
}

std::filesystem::path own_library(const std::string& folder, const std::string& name) {
  const auto library = run::own_folder().parent_path() / "lib" / folder / name;
  if (!std::filesystem::exists(library))
    throw cli::ExitError(cli::kFailed, "there is no " + library.string());
  return library;
}

bool is_preloadable(const std::filesystem::path& library) {
  return library.string().find_first_of(" :") == std::string::npos;
}

std::filesystem::path preloadable(const std::filesystem::path& library, const std::filesystem::path& links) {
  if (is_preloadable(library)) return library;
  const auto link = links / library.filename();
  if (!is_preloadable(link))
    throw cli::ExitError(cli::kFailed,
                         "the loader cannot preload " + library.string() + ", nor a link to it in " +
                             links.string() +
                             ": both paths hold a space or a colon; TMPDIR names another folder");
  std::error_code error;
  std::filesystem::create_symlink(library, link, error);
  if (error) throw cli::ExitError(cli::kFailed, "cannot make " + link.string() + ": " + error.message());
  return link;
}

void preload(const std::string& folder, const std::string& name, const std::filesystem::path& links) {
  append_to_variable("LD_PRELOAD", preloadable(own_library(folder, name), links).string(), ':');
}

}  // namespace visum::exec

// Puts our libraries before a program's own, by the dynamic loader's LD_PRELOAD.
#pragma once

#include <filesystem>
#include <string>

namespace visum::exec {

// Appends `value` to the environment's variable.
void append_to_variable(const char* variable, const std::string& value, char separator);
// Preloads lib/FOLDER/NAME, beside our own bin/, into the program that this process becomes or starts. Makes
// a link in `links` where the loader could not read the library's path. Throws ExitError(kFailed) where the
// library is missing or a link does not help.
void preload(const std::string& folder, const std::string& name, const std::filesystem::path& links);
// lib/FOLDER/NAME, beside our own bin/. Throws ExitError(kFailed) where it is not there.
std::filesystem::path own_library(const std::string& folder, const std::string& name);
// The loader splits LD_PRELOAD at spaces and colons, and has no way to escape them.
bool is_preloadable(const std::filesystem::path& library);
// The library's path, or the path of a link that this makes in `links`. Throws ExitError(kFailed) where the
// loader could read neither.
std::filesystem::path preloadable(const std::filesystem::path& library, const std::filesystem::path& links);

}  // namespace visum::exec

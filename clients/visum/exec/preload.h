// Libraries of ours that the dynamic loader puts before a program's own.
#pragma once

#include <filesystem>
#include <string>

namespace visum::exec {

// `value` behind what the environment's variable holds already.
void append_to_variable(const char* variable, const std::string& value, char separator);
// lib/FOLDER/NAME, beside our own bin/, for what this process becomes or starts; by way of `links` where the
// loader could not read its path. Throws ExitError(kFailed) where it is not where it was installed, or that
// does not help.
void preload(const std::string& folder, const std::string& name, const std::filesystem::path& links);
// lib/FOLDER/NAME, beside our own bin/. Throws ExitError(kFailed) where it is not there.
std::filesystem::path own_library(const std::string& folder, const std::string& name);
// The loader takes spaces and colons for the ends of paths, and knows no other way to write them.
bool is_preloadable(const std::filesystem::path& library);
// The library's path, or that of a link to it which is made in `links`. Throws ExitError(kFailed) where the
// loader could read neither.
std::filesystem::path preloadable(const std::filesystem::path& library, const std::filesystem::path& links);

}  // namespace visum::exec

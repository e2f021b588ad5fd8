// Libraries of ours that the dynamic loader puts before a program's own.
#pragma once

#include <string>

namespace visum::exec {

// `value` behind what the environment's variable holds already.
void append_to_variable(const char* variable, const std::string& value, char separator);
// lib/FOLDER/NAME, beside our own bin/, for what this process becomes or starts. Throws ExitError(kFailed)
// where it is not where it was installed.
void preload(const std::string& folder, const std::string& name);

}  // namespace visum::exec

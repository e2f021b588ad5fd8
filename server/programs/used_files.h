// Tells which files a world was made from, so that others can tell whether a run would be the same again.
#pragma once

#include <string>

#include "protocol/config/read_file.h"

namespace visum::programs {

// Writes a line for each file: XXH64 of its content, a blank, its path. After those that were read come the
// libraries of plug-ins, which are mapped now and do not belong to the system. Throws std::runtime_error.
void write_used_files(const config::Files& read, const std::string& to);

}  // namespace visum::programs

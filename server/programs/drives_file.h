// The verb `visumd drives`: writes a drives file for a model, and a scene around it.
#pragma once

#include "server/programs/command_line.h"

namespace visum::programs {

// Reads the words, writes the file, and returns the exit code.
int write_drives(const Command& command);

}  // namespace visum::programs

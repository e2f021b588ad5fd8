// The output of `visumd replay`: whether a repeated run has the recorded run's bits.
#pragma once

#include <filesystem>

#include "server/recording/replay.h"

namespace visum::programs {

// Repeats the recorded run and prints the result on stdout, as one line of JSON if `json`. Returns the exit
// code: kPassed, kDiffers, or kFailed if the file is damaged. Throws what recording::replay throws.
int report_replay(const std::filesystem::path& file, const recording::PluginFolders& plugins, bool json);

}  // namespace visum::programs

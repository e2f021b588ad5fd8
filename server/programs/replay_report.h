// `visumd replay`, in words: what came of going through a recording again.
#pragma once

#include <filesystem>

#include "server/recording/replay.h"

namespace visum::programs {

// Goes through it, says on stdout what came of it, as one line of JSON where wanted, and returns the exit
// code. Throws what recording::replay throws.
int report_replay(const std::filesystem::path& file, const recording::PluginFolders& plugins, bool json);

}  // namespace visum::programs

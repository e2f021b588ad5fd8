// Where the scenes, models and meshes are that the tests of this folder read.
#pragma once

#include <filesystem>

namespace visum::scene {

inline const std::filesystem::path kData = std::filesystem::path(VISUM_SOURCE_DIR) / "tests/scene/data";

}  // namespace visum::scene

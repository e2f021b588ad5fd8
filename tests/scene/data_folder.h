// The folder with the scenes, models and meshes that the tests here read.
#pragma once

#include <filesystem>

namespace visum::scene {

inline const std::filesystem::path kData = std::filesystem::path(VISUM_SOURCE_DIR) / "tests/scene/data";

}  // namespace visum::scene

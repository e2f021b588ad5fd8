// The engines, each with the settings that are compared: the rows of the physics suite and of the benchmarks.
#pragma once

#include <string>
#include <vector>

#include "server/world/world_model.h"

namespace visum::physics {

struct EngineRow {
  std::string name;  // "impulse-order4"
  world::EngineSetting setting;
};

// The rows whose engine is in the table of this build.
const std::vector<EngineRow>& engine_rows();
// Throws std::runtime_error for an unknown name.
const EngineRow& engine_row(const std::string& name);

}  // namespace visum::physics

// Reads a scenario file (SCENARIOS.md). What only the world can know, as the names of bodies and ports, is
// checked when the world is there.
#pragma once

#include <filesystem>

#include "clients/visum/run/scenario.h"

namespace visum::run {

// One of the runs that the file stands for (sweep.h), counted from 1. Throws config::ConfigError that names
// file, line and key.
Scenario read_scenario(const std::filesystem::path& file);
Scenario read_scenario(const config::Node& file, std::size_t run = 1);

}  // namespace visum::run

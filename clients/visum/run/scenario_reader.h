// Reads a scenario file (SCENARIOS.md). Names of bodies and ports are checked later, when the world is there.
#pragma once

#include <filesystem>

#include "clients/visum/run/scenario.h"
#include "clients/visum/run/sweep.h"

namespace visum::run {

// Returns one of the runs that the file stands for (sweep.h), counted from 1. Throws config::ConfigError,
// which names file, line and key.
Scenario read_scenario(const std::filesystem::path& file);
Scenario read_scenario(const config::Node& file, std::size_t run = 1);
// The run that the sweep's values of `point` make. `run`: what it is called by.
Scenario read_scenario(const config::Node& file, const SweepPoint& point, std::size_t run);

}  // namespace visum::run

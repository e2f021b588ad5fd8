// A run of a sweep as a scenario of its own.
#pragma once

#include <string>

#include "clients/visum/run/sweep.h"
#include "protocol/config/config.h"

namespace visum::campaign {

// The scenario's file `root` with the values of `point` filled in. It may lie in any folder: the scene and
// {scenario_dir} are absolute paths. `engine`: instead of the file's; empty: the file's. `comment`: a line
// above it.
std::string scenario_at(const config::Node& root, const run::SweepPoint& point, const std::string& engine,
                        const std::string& comment);

}  // namespace visum::campaign

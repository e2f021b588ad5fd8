// Which program this is: what a recording says of the build that wrote it, and a replay compares.
#pragma once

#include <string>

#include "protocol/recording/records.h"
#include "server/scene/scene.h"

namespace visum::recording {

Build this_build(const scene::Scene& scene);

// What differs, in words; empty: nothing.
std::string difference(const Build& recorded, const Build& here);

}  // namespace visum::recording

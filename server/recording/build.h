// Names the build of this program: version, commit, compiler, instruction set, engines. A recording holds it,
// and a replay compares it, since another build may compute other bits.
#pragma once

#include <string>

#include "protocol/recording/records.h"
#include "server/scene/scene.h"

namespace visum::recording {

Build this_build(const scene::Scene& scene);

// Says in words what differs; empty: nothing. The engines are not compared.
std::string difference(const Build& recorded, const Build& here);

}  // namespace visum::recording

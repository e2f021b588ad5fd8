// `plugins:` and `agents:` of a scene: what code from outside it uses, and the nodes that only such code can
// make.
#pragma once

#include "server/scene/draft.h"

namespace visum::scene {

// A name of the list `plugins`. Opens it, unless another file has done so.
void read_plugin(Draft& draft, const config::Node& name);

void read_agent(Draft& draft, const config::Node& entry);

// The parts that agents use, by the numbers that they will have; called when all parts and sensors are known.
void find_parts_of_agents(Draft& draft);

inline constexpr std::size_t kMaxAgents = 256;

}  // namespace visum::scene

// Reads `plugins:` and `agents:` of a scene: the plug-ins that it uses, and the agents that they make.
#pragma once

#include "server/scene/draft.h"

namespace visum::scene {

// Reads a name of the list `plugins` and opens that plug-in, unless another file of the scene has opened it.
void read_plugin(Draft& draft, const config::Node& name);

void read_agent(Draft& draft, const config::Node& entry);

// Finds the parts that agents use, by the numbers that they will have. Call it when all parts and sensors are
// known.
void find_parts_of_agents(Draft& draft);

inline constexpr std::size_t kMaxAgents = 256;

}  // namespace visum::scene

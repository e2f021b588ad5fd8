// Reads the entries of `models:`: each places a robot model in the world. Throws ConfigError.
#pragma once

#include "server/scene/draft.h"

namespace visum::scene {

void read_model(Draft& draft, const config::Node& node);

}  // namespace visum::scene

// Reads the entries of `bodies:`. Throws ConfigError.
#pragma once

#include "server/scene/draft.h"

namespace visum::scene {

void read_body(Draft& draft, const config::Node& node);

}  // namespace visum::scene

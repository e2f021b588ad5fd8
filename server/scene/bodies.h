// The entries of `bodies:`.
#pragma once

#include "server/scene/draft.h"

namespace visum::scene {

void read_body(Draft& draft, const config::Node& node);

}  // namespace visum::scene

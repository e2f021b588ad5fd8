// The entries of `parts:`: which joints a part drives. What else stands in an entry is read by the part's
// kind.
#pragma once

#include "server/scene/draft.h"

namespace visum::scene {

// After sort_world: joint ids are final.
void plan_parts(Draft& draft);

}  // namespace visum::scene

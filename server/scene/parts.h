// Reads the entries of `parts:`: which joints a part drives. The kind of the part reads the rest of its
// entry.
#pragma once

#include "server/scene/draft.h"

namespace visum::scene {

// Call it after sort_world(), when the ids of joints are final.
void plan_parts(Draft& draft);

}  // namespace visum::scene

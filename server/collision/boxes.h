// The overlap of two boxes: all separating axes at once, from the one matrix that turns one frame into the
// other. Gottschalk, Lin, Manocha, OBBTree: A hierarchical structure for rapid interference detection,
// SIGGRAPH 1996; Ericson, Real-Time Collision Detection (2005), 4.4.1.
#pragma once

#include "server/collision/penetration.h"

namespace visum::collision {

bool is_box(const Convex& convex);

// The same as find_direction(), for shapes that are both boxes.
Direction find_direction_of_boxes(const Placed& a, const Placed& b);

}  // namespace visum::collision

// Reads the entries of `joints:` and `no_collision:`, and puts the joints of a world into their order.
#pragma once

#include "server/scene/draft.h"

namespace visum::scene {

void read_joint(Draft& draft, const config::Node& node);

// The starting position of a joint that the scene does not place: 0, or the limit nearest to 0.
double nearest_to_zero(const world::Joint& joint);

// Reads [[body, body], ...]. `prefix` ("arm/") is put before each name.
void read_no_collision(Draft& draft, const config::Node& list, const std::string& prefix);

// Sorts joints so that each stands before those below it; otherwise the order of the files remains. Also
// sorts no_collision and keeps each pair once. Throws ConfigError at `place` if the joints form a cycle.
void sort_world(Draft& draft, const config::Place& place);

}  // namespace visum::scene

// The entries of `joints:` and `no_collision:`, and the order in which joints stand in a world.
#pragma once

#include "server/scene/draft.h"

namespace visum::scene {

void read_joint(Draft& draft, const config::Node& node);

// Where a joint starts that no file places: at 0, or at the limit that is nearest to it.
double nearest_to_zero(const world::Joint& joint);

// [[body, body], ...]; `prefix` is put before each name ("arm/").
void read_no_collision(Draft& draft, const config::Node& list, const std::string& prefix);

// Puts joints above others before those below them, else keeps the order of the files. Throws ConfigError at
// `place` if they form a cycle. Also sorts no_collision, each pair once.
void sort_world(Draft& draft, const config::Place& place);

}  // namespace visum::scene

// Finds the links of an MJCF file that never collide: contype and conaffinity, <exclude>, <pair>, and
// neighbours.
#pragma once

#include "server/scene/mjcf/bodies.h"

namespace visum::scene::mjcf {

// Geoms that a <pair> names collide, whatever their own bits say. Call it before the links are made.
void let_pairs_collide(Reading& reading, std::vector<BodyEntry>& bodies);

// Fills RobotModel::no_collision. Pairs of links of which only some geoms may touch collide, with a loss.
void separate_links(Reading& reading, const std::vector<BodyEntry>& bodies);

}  // namespace visum::scene::mjcf

// Makes links and joints of the bodies of an MJCF file.
#pragma once

#include "server/scene/mjcf/bodies.h"

namespace visum::scene::mjcf {

// Bodies become links and their joints joints of the model. Between two joints of one body stands a link of
// a small share of its mass, "BODY~JOINT". Throws nothing; errors and losses go to `reading`.
void add_links(Reading& reading, const std::vector<BodyEntry>& bodies);

// The link of a body in the model: "world" for the world itself.
std::string link_of(const std::vector<BodyEntry>& bodies, std::size_t body);

// Each link between two joints of a body has this share of the body's mass and inertia.
inline constexpr double kShareBetweenJoints = 1e-4;

}  // namespace visum::scene::mjcf

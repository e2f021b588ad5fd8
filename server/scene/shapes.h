// Reads the entries of `shapes:`. Throws ConfigError.
#pragma once

#include "server/scene/draft.h"
#include "server/scene/inertia.h"

namespace visum::scene {

// A body's settings for those of its shapes that have none of their own.
struct ShapeDefaults {
  world::SurfaceId surface{0};
  std::array<double, 4> color = world::Shape{}.color;
  std::int32_t material = -1;
};

// Reads `surface`, `material` and `color` of a body or shape; a missing one is taken from `otherwise`. A
// material sets the colour, too, unless there is a `color` beside it.
ShapeDefaults read_defaults(const Draft& draft, const config::Node& node, const ShapeDefaults& otherwise);

// Reads one shape, which belongs to no body yet. Meshes are read into the draft.
world::Shape read_shape(Draft& draft, const config::Node& node, std::size_t index,
                        const ShapeDefaults& defaults);

// The shape as a solid of density 1, in the body's frame. Throws at `node` for a mesh that encloses nothing.
MassProperties solid_in_body(const Draft& draft, const world::Shape& shape, const config::Node& node);

}  // namespace visum::scene

// The entries of `shapes:`.
#pragma once

#include "server/scene/draft.h"
#include "server/scene/inertia.h"

namespace visum::scene {

// What a body gives to those of its shapes that do not say it themselves.
struct ShapeDefaults {
  world::SurfaceId surface{0};
  std::array<double, 4> color = world::Shape{}.color;
  std::int32_t material = -1;
};

// `surface`, `material` and `color` of a body or shape; what it does not say is as in `otherwise`. A material
// brings its colour along, unless there is one beside it.
ShapeDefaults read_defaults(const Draft& draft, const config::Node& node, const ShapeDefaults& otherwise);

// One shape, on no body yet. Meshes are read into the draft.
world::Shape read_shape(Draft& draft, const config::Node& node, std::size_t index,
                        const ShapeDefaults& defaults);

// The shape as a solid of density 1 in the body's frame. Fails at `node` for a mesh that encloses nothing.
MassProperties solid_in_body(const Draft& draft, const world::Shape& shape, const config::Node& node);

}  // namespace visum::scene

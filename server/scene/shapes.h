// The entries of `shapes:`.
#pragma once

#include "server/scene/draft.h"
#include "server/scene/inertia.h"

namespace visum::scene {

// What a body gives to those of its shapes that do not say it themselves.
struct Looks {
  world::SurfaceId surface{0};
  std::array<double, 4> color = world::Shape{}.color;
};

// One shape, on no body yet. Meshes are read into the draft.
world::Shape read_shape(Draft& draft, const config::Node& node, std::size_t index, const Looks& looks);

// The shape as a solid of density 1 in the body's frame. Fails at `node` for a mesh that encloses nothing.
MassProperties solid_in_body(const Draft& draft, const world::Shape& shape, const config::Node& node);

}  // namespace visum::scene

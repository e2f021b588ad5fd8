// Convex hulls in the place of meshes that collide. Pure functions.
#pragma once

#include "server/world/world_model.h"

namespace visum::scene {

// Collisions search all vertices of a hull, so that large ones are thinned out.
inline constexpr std::size_t kMaxHullVertices = 512;
// The mesh itself if it has no more vertices than that; else those that lie farthest out in 642 directions.
// Its surface lies inside of the hull by at most 0.4 % of the hull's radius.
world::TriangleMesh thin_hull(const world::TriangleMesh& mesh);

// True if the vertices lie in a plane, so that their hull has no volume.
bool is_flat(const world::TriangleMesh& mesh);

// A unit ball of 642 vertices.
world::TriangleMesh ball_mesh();

}  // namespace visum::scene

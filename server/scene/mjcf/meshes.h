// Triangle meshes as MJCF needs them: their mass as MuJoCo counts it, and MuJoCo's own mesh format. Pure
// functions.
#pragma once

#include <string>
#include <string_view>

#include "protocol/config/config.h"
#include "server/scene/inertia.h"

namespace visum::scene::mjcf {

// The solid has a density of 1 kg/m³. MuJoCo sums pyramids over all triangles, from the middle of the
// surface. Unless `exact`, pyramids count positive even if their triangle is seen from behind, so that open
// meshes and those with faces turned inside out have a mass, too. It is the exact one for convex meshes.
MassProperties solid_of_mesh(const world::TriangleMesh& mesh, bool exact);

// The mesh format .msh of old versions of MuJoCo. Throws ConfigError at `place`.
world::TriangleMesh read_msh(std::string_view bytes, const config::Place& place);

}  // namespace visum::scene::mjcf

// Between scenes and X3D: its Rigid Body Physics component (ISO/IEC 19775-1, clause 37) for bodies, joints
// and gravity, its shapes, lights and viewpoints for how they look. What X3D has no field for, and what it
// would round, stands in MetadataString nodes called "visum", as YAML; where such a node no longer agrees
// with the fields beside it, because an editor has moved something, the fields hold.
#pragma once

#include "server/scene/convert/output.h"
#include "server/scene/convert/x3d_node.h"
#include "server/scene/scene.h"

namespace visum::scene {

// `physics`: false for VRML97, which has no nodes for bodies and joints.
X3dNode to_x3d(const Scene& scene, Output& output, bool physics);

// Throws ConfigError at the node that is wrong. Shapes beside all bodies become a fixed body "scenery".
Scene scene_of_x3d(const X3dNode& root, const std::filesystem::path& file);

inline constexpr const char* kMetadataName = "visum";

}  // namespace visum::scene

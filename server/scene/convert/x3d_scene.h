// Translates between scenes and X3D. Bodies, joints and gravity use X3D's Rigid Body Physics component
// (ISO/IEC 19775-1, clause 37), looks use its shapes, lights and viewpoints. Values that X3D has no field
// for, or would round, stand as YAML in MetadataString nodes named "visum". If such a node does not agree
// with the fields beside it, because an editor has moved something, the fields win.
#pragma once

#include "server/scene/convert/output.h"
#include "server/scene/convert/x3d_node.h"
#include "server/scene/scene.h"

namespace visum::scene {

// `physics`: false for VRML97, which has no nodes for bodies and joints.
X3dNode to_x3d(const Scene& scene, Output& output, bool physics);

// Throws ConfigError at the node that is wrong. Shapes outside of all bodies become a fixed body "scenery".
Scene scene_of_x3d(const X3dNode& root, const std::filesystem::path& file);

inline constexpr const char* kMetadataName = "visum";

}  // namespace visum::scene

// Reads a file of X3D or VRML97 as one tree: instances of prototypes (PROTO, EXTERNPROTO) become the nodes of
// their bodies, and each Inline becomes a Group of the nodes of its file. Only local files are opened.
#pragma once

#include <filesystem>

#include "server/scene/convert/x3d_node.h"

namespace visum::scene {

inline constexpr std::size_t kMaxX3dFiles = 256;                       // files read for one scene
inline constexpr std::size_t kMaxX3dInlineDepth = 16;                  // files that each inline the next
inline constexpr std::size_t kMaxX3dAllBytes = std::size_t{64} << 20;  // of all files; of all values

// The encoding follows the extension: .x3d is XML, all others are classic. Throws ConfigError with file and
// line; besides what is wrong with one file, for prototypes that do not exist, files that inline themselves,
// missing files, and beyond the limits.
X3dNode read_x3d_file(const std::filesystem::path& file);

}  // namespace visum::scene

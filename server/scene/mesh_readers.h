// Reads triangle meshes from STL (binary and text) and OBJ files. These are own readers, because general
// importers have a record of overflows. Every count is checked against the file's size before memory is
// taken. Vertices are finite. Equal vertices are joined, so that a closed surface is closed in its indices,
// too.
#pragma once

#include <filesystem>
#include <string_view>

#include "protocol/config/config.h"
#include "server/world/point_numbers.h"
#include "server/world/world_model.h"

namespace visum::scene {

inline constexpr std::size_t kMaxMeshBytes = 128u << 20;  // kMaxTriangles in binary STL take 100 MB

// Reads by the file's extension. Throws ConfigError at the line of the mesh that is wrong, or at `wanted_by`
// if there is no such file or its format is unknown. Lengths are in the file's own unit; the caller scales
// them.
world::TriangleMesh read_mesh(const std::filesystem::path& file, const config::Place& wanted_by);

// ".stl" for "arm.STL".
std::string lower_extension(const std::filesystem::path& file);

// True for the formats that read_mesh() reads.
bool is_mesh_format(const std::filesystem::path& file);

// The readers for each format. `file` names the place in errors.
world::TriangleMesh read_stl(std::string_view bytes, const std::string& file);
world::TriangleMesh read_obj(std::string_view text, const std::string& file);

// Collects triangles and joins equal vertices, in the order of their first use.
class MeshBuilder {
 public:
  explicit MeshBuilder(std::string file) : file_(std::move(file)) {}

  // Throws ConfigError at `line` for a vertex that is not finite, and beyond kMaxTriangles. A triangle with
  // two equal corners is left out: it has no area, and its edges do not matter.
  void add(const std::array<Eigen::Vector3d, 3>& corners, int line);

  world::TriangleMesh take();  // throws ConfigError if there is no triangle

 private:
  std::string file_;
  world::TriangleMesh mesh_;
  world::PointNumbers vertices_;
};

}  // namespace visum::scene

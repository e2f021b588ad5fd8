// Triangle meshes from STL (binary and text) and OBJ files: own readers, because general importers have a
// record of overflows. Every count is checked against the file before memory is taken; vertices are finite,
// equal ones are joined, so that a closed surface is closed in its indices too.
#pragma once

#include <filesystem>
#include <string_view>
#include <unordered_map>

#include "protocol/config/config.h"
#include "server/world/world_model.h"

namespace visum::scene {

inline constexpr std::size_t kMaxMeshBytes = 128u << 20;  // kMaxTriangles in binary STL take 100 MB

// By the file's extension; throws ConfigError at the mesh's own line, or at `wanted_by` where there is no
// such file or it is of another format. Triangles are counted in the file's own unit: scaling is the
// caller's.
world::TriangleMesh read_mesh(const std::filesystem::path& file, const config::Place& wanted_by);

// ".stl" of "arm.STL".
std::string lower_extension(const std::filesystem::path& file);

// True for the formats that read_mesh takes.
bool is_mesh_format(const std::filesystem::path& file);

// The readers behind it; `file` only names the place in errors.
world::TriangleMesh read_stl(std::string_view bytes, const std::string& file);
world::TriangleMesh read_obj(std::string_view text, const std::string& file);

// Collects triangles, joining equal vertices in the order of their first use.
class MeshBuilder {
 public:
  explicit MeshBuilder(std::string file) : file_(std::move(file)) {}

  // Throws ConfigError at `line` for a vertex that is not finite, and beyond kMaxTriangles. A triangle with
  // two equal corners is left out: it has no area and no edge that counts.
  void add(const std::array<Eigen::Vector3d, 3>& corners, int line);

  world::TriangleMesh take();  // throws ConfigError if there is no triangle

 private:
  struct Hash {
    std::size_t operator()(const std::array<double, 3>& point) const;
  };
  std::uint32_t index_of(const Eigen::Vector3d& point);

  std::string file_;
  world::TriangleMesh mesh_;
  std::unordered_map<std::array<double, 3>, std::uint32_t, Hash> indices_;  // only looked up, never walked
};

}  // namespace visum::scene

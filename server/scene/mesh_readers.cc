#include "server/scene/mesh_readers.h"

#include <algorithm>
#include <cctype>

#include "protocol/config/read_file.h"

namespace visum::scene {

void MeshBuilder::add(const std::array<Eigen::Vector3d, 3>& corners, int line) {
  if (mesh_.triangles.size() == world::kMaxTriangles)
    throw config::ConfigError({file_, line, ""},
                              "more than " + std::to_string(world::kMaxTriangles) + " triangles");
  std::array<std::uint32_t, 3> triangle{};
  for (std::size_t i = 0; i < 3; ++i) {
    if (!corners[i].allFinite())
      throw config::ConfigError({file_, line, ""}, "triangle " + std::to_string(mesh_.triangles.size()) +
                                                       " has a vertex that is not finite");
    triangle[i] = vertices_.number(corners[i]);
  }
  const bool degenerate =
      triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0];
  if (!degenerate) mesh_.triangles.push_back(triangle);
}

world::TriangleMesh MeshBuilder::take() {
  if (mesh_.triangles.empty()) throw config::ConfigError({file_, 0, ""}, "holds no triangle");
  mesh_.vertices = vertices_.take_points();
  return std::move(mesh_);
}

std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool is_mesh_format(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  return extension == ".stl" || extension == ".obj";
}

world::TriangleMesh read_mesh(const std::filesystem::path& file, const config::Place& wanted_by) {
  const std::string shown = file.string();
  if (!is_mesh_format(file))
    throw config::ConfigError(wanted_by, "'" + shown + "': is not a mesh that can be read (.stl or .obj)");
  config::FileContent content = config::read_file(file, kMaxMeshBytes);
  if (!content.fault.empty()) throw config::ConfigError(wanted_by, "'" + shown + "': " + content.fault);
  world::TriangleMesh mesh =
      lower_extension(file) == ".stl" ? read_stl(content.bytes, shown) : read_obj(content.bytes, shown);
  mesh.name = file.filename().string();
  return mesh;
}

}  // namespace visum::scene

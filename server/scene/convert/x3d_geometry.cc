#include "server/scene/convert/x3d_geometry.h"

#include <cmath>
#include <numbers>

#include "server/scene/convert/x3d_text.h"

namespace visum::scene {
namespace {

using world::ShapeKind;

constexpr int kConeSides = 32;

double length(const X3dNode& node, const std::string& field, double otherwise, const std::string& file) {
  const double number = numbers_of(node, field, 1, {otherwise}, file)[0];
  if (!(number > 0.0)) fail_at(node, file, field + " must be greater than 0");
  return number;
}

// A cone about y, with its tip up, as a mesh.
world::TriangleMesh cone(double radius, double height) {
  world::TriangleMesh mesh;
  mesh.vertices.emplace_back(0, height / 2, 0);
  mesh.vertices.emplace_back(0, -height / 2, 0);
  for (int i = 0; i < kConeSides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kConeSides;
    mesh.vertices.emplace_back(radius * std::sin(angle), -height / 2, radius * std::cos(angle));
  }
  for (std::uint32_t i = 0; i < kConeSides; ++i) {
    const std::uint32_t here = 2 + i, next = 2 + (i + 1) % kConeSides;
    mesh.triangles.push_back({0, here, next});
    mesh.triangles.push_back({1, next, here});
  }
  return mesh;
}

std::vector<Eigen::Vector3d> points_of(const X3dNode& node, const std::string& file,
                                       const std::function<const X3dNode&(const X3dNode&)>& resolved) {
  for (const auto& [field, child] : node.children) {
    if (field != "coord") continue;
    const X3dNode& coord = resolved(child);
    const auto numbers = numbers_of(coord, "point", 0, {}, file);
    if (numbers.size() % 3 != 0)
      fail_at(coord, file, "point must have 3 numbers for each point, has " + std::to_string(numbers.size()));
    std::vector<Eigen::Vector3d> points;
    for (std::size_t i = 0; i < numbers.size(); i += 3)
      points.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    return points;
  }
  fail_at(node, file, "has no coord");
}

std::uint32_t index_of_point(const X3dNode& node, double number, std::size_t points,
                             const std::string& file) {
  if (number != std::floor(number) || number < 0 || number >= static_cast<double>(points))
    fail_at(node, file,
            "names point " + std::to_string(static_cast<long long>(number)) + ", there are " +
                std::to_string(points));
  return static_cast<std::uint32_t>(number);
}

// Reads faces, each of which ends with -1, as fans of triangles.
void faces(const X3dNode& node, const std::string& file, world::TriangleMesh& mesh) {
  std::vector<std::uint32_t> face;
  const auto end_face = [&] {
    for (std::size_t i = 2; i < face.size(); ++i) mesh.triangles.push_back({face[0], face[i - 1], face[i]});
    face.clear();
  };
  for (const double number : numbers_of(node, "coordIndex", 0, {}, file)) {
    if (number == -1.0)
      end_face();
    else
      face.push_back(index_of_point(node, number, mesh.vertices.size(), file));
  }
  end_face();
}

void triangles(const X3dNode& node, const std::string& file, world::TriangleMesh& mesh) {
  std::vector<double> indices;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) indices.push_back(static_cast<double>(i));
  if (node.type == "IndexedTriangleSet") indices = numbers_of(node, "index", 0, {}, file);
  if (indices.size() % 3 != 0)
    fail_at(node, file, "must have 3 points for each triangle, has " + std::to_string(indices.size()));
  for (std::size_t i = 0; i < indices.size(); i += 3)
    mesh.triangles.push_back({index_of_point(node, indices[i], mesh.vertices.size(), file),
                              index_of_point(node, indices[i + 1], mesh.vertices.size(), file),
                              index_of_point(node, indices[i + 2], mesh.vertices.size(), file)});
}

bool is_mesh(const std::string& type) {
  return type == "IndexedFaceSet" || type == "IndexedTriangleSet" || type == "TriangleSet";
}

}  // namespace

std::optional<X3dForm> read_x3d_geometry(const X3dNode& node, const Eigen::Vector3d& scale,
                                         const std::string& file,
                                         const std::function<const X3dNode&(const X3dNode&)>& resolved) {
  X3dForm form;
  const double factor = scale[0];
  if (node.type == "Box") {
    const auto size = numbers_of(node, "size", 3, {2, 2, 2}, file);
    for (std::size_t i = 0; i < 3; ++i) form.size[i] = factor * size[i];
  } else if (node.type == "Sphere") {
    form.kind = ShapeKind::kSphere;
    form.size[0] = factor * length(node, "radius", 1.0, file);
  } else if (node.type == "Cylinder") {
    form.kind = ShapeKind::kCylinder;
    form.size = {factor * length(node, "radius", 1.0, file), factor * length(node, "height", 2.0, file), 0.0};
    form.q_NS = from_y_to_z().conjugate();
  } else if (node.type == "Cone" || is_mesh(node.type)) {
    form.kind = ShapeKind::kMesh;
    if (node.type == "Cone") {
      form.mesh = cone(length(node, "bottomRadius", 1.0, file), length(node, "height", 2.0, file));
    } else {
      form.mesh.vertices = points_of(node, file, resolved);
      node.type == "IndexedFaceSet" ? faces(node, file, form.mesh) : triangles(node, file, form.mesh);
    }
    if (form.mesh.triangles.empty()) fail_at(node, file, "has no faces");
    for (auto& vertex : form.mesh.vertices) vertex *= factor;
  } else {
    return std::nullopt;
  }
  return form;
}

}  // namespace visum::scene

#include "server/scene/convert/x3d_geometry.h"

#include <cmath>
#include <numbers>

#include "protocol/config/trig.h"
#include "server/scene/convert/x3d_text.h"

namespace visum::scene {
namespace {

using world::ShapeKind;

constexpr int kSides = 32;  // of round things
constexpr int kRings = 15;  // of a sphere, without its poles
constexpr double kSameScale = 1e-4;

double length(const X3dNode& node, const std::string& field, double otherwise, const std::string& file) {
  const double number = numbers_of(node, field, 1, {otherwise}, file)[0];
  if (!(number > 0.0)) fail_at(node, file, field + " must be greater than 0");
  return number;
}

// Adds a circle about y.
void add_ring(double radius, double y, world::TriangleMesh& mesh) {
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kSides;
    const auto [sine, cosine] = config::sin_cos(angle);
    mesh.vertices.emplace_back(radius * sine, y, radius * cosine);
  }
}

// A cone about y, with its tip up, as a mesh.
world::TriangleMesh cone(double radius, double height) {
  world::TriangleMesh mesh;
  mesh.vertices.emplace_back(0, height / 2, 0);
  mesh.vertices.emplace_back(0, -height / 2, 0);
  add_ring(radius, -height / 2, mesh);
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t here = 2 + i, next = 2 + (i + 1) % kSides;
    mesh.triangles.push_back({0, here, next});
    mesh.triangles.push_back({1, next, here});
  }
  return mesh;
}

// A surface of rings about y, closed by two points.
world::TriangleMesh rings(const std::vector<std::pair<double, double>>& radius_and_y, double top,
                          double bottom) {
  world::TriangleMesh mesh;
  mesh.vertices.emplace_back(0, top, 0);
  mesh.vertices.emplace_back(0, bottom, 0);
  for (const auto& [radius, y] : radius_and_y) add_ring(radius, y, mesh);
  const auto last = static_cast<std::uint32_t>(2 + kSides * (radius_and_y.size() - 1));
  for (std::uint32_t i = 0; i < kSides; ++i) {
    const std::uint32_t next = (i + 1) % kSides;
    mesh.triangles.push_back({0, 2 + i, 2 + next});
    for (std::uint32_t ring = 2; ring < last; ring += kSides) {
      mesh.triangles.push_back({ring + i, ring + kSides + i, ring + kSides + next});
      mesh.triangles.push_back({ring + i, ring + kSides + next, ring + next});
    }
    mesh.triangles.push_back({1, last + next, last + i});
  }
  return mesh;
}

world::TriangleMesh mesh_of_sphere(double radius) {
  std::vector<std::pair<double, double>> circles;
  for (int i = 1; i <= kRings; ++i) {
    const double angle = std::numbers::pi * i / (kRings + 1);
    const auto [sine, cosine] = config::sin_cos(angle);
    circles.emplace_back(radius * sine, radius * cosine);
  }
  return rings(circles, radius, -radius);
}

world::TriangleMesh mesh_of_box(const std::vector<double>& size) {
  world::TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.emplace_back((i & 1 ? 0.5 : -0.5) * size[0], (i & 2 ? 0.5 : -0.5) * size[1],
                               (i & 4 ? 0.5 : -0.5) * size[2]);
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
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

bool is_diagonal(const Eigen::Matrix3d& stretch) {
  const Eigen::Matrix3d beside = stretch - Eigen::Matrix3d(stretch.diagonal().asDiagonal());
  return beside.cwiseAbs().maxCoeff() <= 1e-6 * stretch.cwiseAbs().maxCoeff();
}

bool same(double a, double b) {
  return std::abs(a - b) <= kSameScale * b;
}

// The form with this mesh, stretched. A mesh that is turned inside out by it is turned back.
X3dForm of_mesh(X3dForm form, world::TriangleMesh mesh, const Eigen::Matrix3d& stretch) {
  for (Eigen::Vector3d& vertex : mesh.vertices) vertex = stretch * vertex;
  if (stretch.determinant() < 0)
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  form.mesh = std::move(mesh);
  return form;
}

}  // namespace

bool is_x3d_mesh(const std::string& type) {
  return type == "IndexedFaceSet" || type == "IndexedTriangleSet" || type == "TriangleSet";
}

std::optional<X3dForm> read_x3d_geometry(const X3dNode& node, const Eigen::Matrix3d& stretch,
                                         const std::string& file,
                                         const std::function<const X3dNode&(const X3dNode&)>& resolved) {
  X3dForm form;
  const bool along_axes = is_diagonal(stretch);
  const Eigen::Vector3d factor = stretch.diagonal().cwiseAbs();
  form.kind = ShapeKind::kConvex;
  if (node.type == "Box") {
    const auto size = numbers_of(node, "size", 3, {2, 2, 2}, file);
    if (!along_axes) return of_mesh(form, mesh_of_box(size), stretch);
    form.kind = ShapeKind::kBox;
    for (int i = 0; i < 3; ++i)
      form.size[static_cast<std::size_t>(i)] = factor[i] * size[static_cast<std::size_t>(i)];
  } else if (node.type == "Sphere") {
    const double radius = length(node, "radius", 1.0, file);
    if (!along_axes || !same(factor[0], factor[1]) || !same(factor[0], factor[2]))
      return of_mesh(form, mesh_of_sphere(radius), stretch);
    form.kind = ShapeKind::kSphere;
    form.size[0] = factor[0] * radius;
  } else if (node.type == "Cylinder") {
    const double radius = length(node, "radius", 1.0, file), height = length(node, "height", 2.0, file);
    if (!along_axes || !same(factor[0], factor[2]))
      return of_mesh(form, rings({{radius, height / 2}, {radius, -height / 2}}, height / 2, -height / 2),
                     stretch);
    form.kind = ShapeKind::kCylinder;
    form.size = {factor[0] * radius, factor[1] * height, 0.0};
    form.q_NS = from_y_to_z().conjugate();
  } else if (node.type == "Cone" || is_x3d_mesh(node.type)) {
    form.kind = ShapeKind::kMesh;
    world::TriangleMesh mesh;
    if (node.type == "Cone") {
      mesh = cone(length(node, "bottomRadius", 1.0, file), length(node, "height", 2.0, file));
    } else {
      mesh.vertices = points_of(node, file, resolved);
      node.type == "IndexedFaceSet" ? faces(node, file, mesh) : triangles(node, file, mesh);
    }
    if (mesh.triangles.empty()) return std::nullopt;
    return of_mesh(form, std::move(mesh), stretch);
  } else {
    return std::nullopt;
  }
  return form;
}

}  // namespace visum::scene

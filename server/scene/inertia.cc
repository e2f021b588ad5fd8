#include "server/scene/inertia.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

namespace visum::scene {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kMinVolume = 1e-18;  // m³: a cube with sides of a micrometre

MassProperties centred(double volume, double ixx, double iyy, double izz) {
  return {volume, Vector3d::Zero(), Vector3d(ixx, iyy, izz).asDiagonal()};
}

MassProperties solid_box(double x, double y, double z) {
  const double m = x * y * z;
  return centred(m, m * (y * y + z * z) / 12, m * (x * x + z * z) / 12, m * (x * x + y * y) / 12);
}

MassProperties solid_sphere(double r) {
  const double m = 4.0 / 3.0 * pi * r * r * r;
  const double i = 0.4 * m * r * r;
  return centred(m, i, i, i);
}

MassProperties solid_cylinder(double r, double length) {
  const double m = pi * r * r * length;
  const double across = m * (3 * r * r + length * length) / 12;
  return centred(m, across, across, m * r * r / 2);
}

// A cylinder and two half spheres. The centre of mass of a half sphere lies 3r/8 above its disc; its inertia
// about that centre, across the axis, is 83/320 m r².
MassProperties solid_capsule(double r, double length) {
  MassProperties capsule = solid_cylinder(r, length);
  const double half = 2.0 / 3.0 * pi * r * r * r;
  const double arm = length / 2 + 3.0 / 8.0 * r;
  const double across = 2 * half * (83.0 / 320.0 * r * r + arm * arm);
  capsule.mass_kg += 2 * half;
  capsule.inertia_C += Vector3d(across, across, 2 * 0.4 * half * r * r).asDiagonal();
  return capsule;
}

Matrix3d inertia_from_second_moments(const Matrix3d& moments) {
  return moments.trace() * Matrix3d::Identity() - moments;
}

// The inertia of a point mass at `offset` (parallel axis theorem).
Matrix3d point_inertia(double mass, const Vector3d& offset) {
  return mass * inertia_from_second_moments(offset * offset.transpose());
}

// Sums the tetrahedra between a vertex of the mesh and each triangle. Tetrahedra whose triangle is seen from
// behind count negative. Over a tetrahedron (0, a, b, c) of volume V: integral of x x^T = V/20 (aa^T + bb^T +
// cc^T + ss^T), s = a + b + c.
MassProperties solid_mesh(const world::TriangleMesh& mesh) {
  const Vector3d origin = mesh.vertices.front();
  double volume = 0.0;
  Vector3d first = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero();
  for (const auto& triangle : mesh.triangles) {
    const Vector3d a = mesh.vertices[triangle[0]] - origin;
    const Vector3d b = mesh.vertices[triangle[1]] - origin;
    const Vector3d c = mesh.vertices[triangle[2]] - origin;
    const Vector3d s = a + b + c;
    const double v = a.dot(b.cross(c)) / 6;
    volume += v;
    first += v * s / 4;
    second += v / 20 * (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
  }
  // All triangles face inwards: the same solid with every sign reversed.
  if (volume < 0) {
    volume = -volume;
    first = -first;
    second = -second;
  }
  if (volume <= 0) return {};
  const Vector3d com = first / volume;
  return {volume, origin + com, inertia_from_second_moments(second) - point_inertia(volume, com)};
}

// An edge of a triangle, with its vertices in order of their numbers.
struct Edge {
  std::uint32_t low, high;
  int direction;  // +1: from low to high
};

// A mesh is closed if its triangles walk each edge as often one way as the other. That also finds faces
// turned inside out.
bool is_closed(const world::TriangleMesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(mesh.triangles.size() * 3);
  for (const auto& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t from = t[i], to = t[(i + 1) % 3];
      edges.push_back({std::min(from, to), std::max(from, to), from < to ? 1 : -1});
    }
  }
  const auto key = [](const Edge& e) { return std::pair(e.low, e.high); };
  std::sort(edges.begin(), edges.end(), [&](const Edge& a, const Edge& b) { return key(a) < key(b); });
  for (std::size_t i = 0; i < edges.size();) {
    const auto edge = key(edges[i]);
    int balance = 0;
    for (; i < edges.size() && key(edges[i]) == edge; ++i) balance += edges[i].direction;
    if (balance != 0) return false;
  }
  return true;
}

}  // namespace

MassProperties solid_of(const world::Shape& shape, const world::TriangleMesh* mesh) {
  switch (shape.kind) {
    case world::ShapeKind::kBox:
      return solid_box(shape.size[0], shape.size[1], shape.size[2]);
    case world::ShapeKind::kSphere:
      return solid_sphere(shape.size[0]);
    case world::ShapeKind::kCylinder:
      return solid_cylinder(shape.size[0], shape.size[1]);
    case world::ShapeKind::kCapsule:
      return solid_capsule(shape.size[0], shape.size[1]);
    case world::ShapeKind::kConvex:
    case world::ShapeKind::kMesh:
      return solid_mesh(*mesh);
    case world::ShapeKind::kPlane:
      break;
  }
  return {};
}

std::string solid_fault(const world::TriangleMesh& mesh) {
  if (!is_closed(mesh)) return "is not closed (an edge has no neighbour, or faces are turned inside out)";
  if (solid_mesh(mesh).mass_kg < kMinVolume) return "encloses no volume";
  return "";
}

bool is_of_a_solid(const Matrix3d& inertia, double tolerance) {
  const Vector3d m =
      Eigen::SelfAdjointEigenSolver<Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();  // ascending
  return m[0] > 0.0 && m[0] + m[1] >= m[2] * (1.0 - tolerance);
}

MassProperties scaled(const MassProperties& part, double factor) {
  return {part.mass_kg * factor, part.com, part.inertia_C * factor};
}

MassProperties moved(const MassProperties& part, const world::Pose& X_BS) {
  const Matrix3d R = X_BS.q.toRotationMatrix();
  return {part.mass_kg, X_BS * part.com, R * part.inertia_C * R.transpose()};
}

// Adds both, about their common centre of mass.
MassProperties together(const MassProperties& a, const MassProperties& b) {
  const double mass = a.mass_kg + b.mass_kg;
  if (mass <= 0) return {};
  const Vector3d com = (a.mass_kg * a.com + b.mass_kg * b.com) / mass;
  return {mass, com,
          a.inertia_C + b.inertia_C + point_inertia(a.mass_kg, a.com - com) +
              point_inertia(b.mass_kg, b.com - com)};
}

}  // namespace visum::scene

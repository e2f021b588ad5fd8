#include <Eigen/Eigenvalues>

#include "server/world/fault_text.h"

namespace visum::world {
namespace {

constexpr double kMinSizeM = 1e-6;
constexpr std::size_t kMinHullVertices = 4;
constexpr std::size_t kMaxHullVertices = 4096;  // the search for a support point is linear
// Least over largest spread of the vertices, as squared lengths. A hull that is flatter has no volume.
constexpr double kMinHullFlatness = 1e-9;

std::string friction_fault(const Surface& surface) {
  if (!is_in_range(surface.friction, 0.0, kMaxMagnitude)) return "needs a friction of at least 0";
  if (!is_in_range(surface.restitution, 0.0, 1.0)) return "needs a restitution from 0 to 1";
  if (!is_in_range(surface.rolling_friction, 0.0, kMaxMagnitude))
    return "needs a rolling friction of at least 0";
  if (!is_in_range(surface.torsional_friction, 0.0, kMaxMagnitude))
    return "needs a torsional friction of at least 0";
  return "";
}

std::string surface_fault(const Surface& surface) {
  const std::string fault = friction_fault(surface);
  return fault.empty() ? "" : "surface " + quoted(surface.name) + " " + fault;
}

std::string triangles_fault(const TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return "has no vertices";
  for (const Eigen::Vector3d& vertex : mesh.vertices) {
    if (!is_placed(vertex)) return "has a vertex that is not finite or beyond 1e6 m";
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) {
      if (corner >= mesh.vertices.size()) return "has a triangle with a vertex that does not exist";
    }
  }
  return "";
}

std::string mesh_fault(const TriangleMesh& mesh) {
  const std::string fault = triangles_fault(mesh);
  return fault.empty() ? "" : "mesh " + quoted(mesh.name) + " " + fault;
}

bool has_volume(const TriangleMesh& mesh) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& vertex : mesh.vertices) mean += vertex / static_cast<double>(mesh.vertices.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& vertex : mesh.vertices) spread += (vertex - mean) * (vertex - mean).transpose();
  const Eigen::Vector3d lengths = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvalues();
  return lengths[0] > kMinHullFlatness * lengths[2];
}

std::string hull_fault(const TriangleMesh& mesh) {
  if (mesh.vertices.size() < kMinHullVertices || !has_volume(mesh)) return "is a hull without volume";
  if (mesh.vertices.size() > kMaxHullVertices) return "is a hull of more than 4096 vertices";
  return "";
}

std::string size_fault(const Shape& shape, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_in_range(shape.size[i], kMinSizeM, kMaxMagnitude)) return "needs sizes between 1e-6 and 1e6 m";
  }
  return "";
}

std::string kind_fault(const WorldModel& model, const Shape& shape) {
  switch (shape.kind) {
    case ShapeKind::kBox:
      return size_fault(shape, 3);
    case ShapeKind::kSphere:
      return size_fault(shape, 1);
    case ShapeKind::kCylinder:
    case ShapeKind::kCapsule:
      return size_fault(shape, 2);
    case ShapeKind::kPlane:
      return model.bodies[shape.body.index()].fixed ? "" : "is a plane on a body that moves";
    case ShapeKind::kConvex:
    case ShapeKind::kMesh:
      break;
    default:
      return "is of no known kind";
  }
  if (!shape.mesh.valid() || shape.mesh.index() >= model.meshes.size()) return "has no mesh";
  const TriangleMesh& mesh = model.meshes[shape.mesh.index()];
  if (shape.kind == ShapeKind::kConvex) return hull_fault(mesh);
  return mesh.triangles.empty() ? "has a mesh without triangles" : "";
}

std::string shape_fault(const WorldModel& model, const Shape& shape) {
  if (!shape.body.valid() || shape.body.index() >= model.bodies.size()) return "is on no body";
  if (!shape.surface.valid() || shape.surface.index() >= model.surfaces.size()) return "has no surface";
  if (const std::string fault = pose_fault(shape.X_BS); !fault.empty()) return fault;
  return kind_fault(model, shape);
}

std::string find_surface_and_mesh_fault(const WorldModel& model) {
  for (const Surface& surface : model.surfaces) {
    if (std::string fault = surface_fault(surface); !fault.empty()) return fault;
  }
  std::size_t triangles = 0;
  for (const TriangleMesh& mesh : model.meshes) {
    if (std::string fault = mesh_fault(mesh); !fault.empty()) return fault;
    triangles += mesh.triangles.size();
  }
  if (triangles > kMaxTriangles) return "there are more than " + std::to_string(kMaxTriangles) + " triangles";
  return "";
}

// Without the shape's surface and mesh, which find_fault() checks once and not for each shape.
std::string own_fault(const WorldModel& model, const Shape& shape) {
  const std::string fault = shape_fault(model, shape);
  return fault.empty() ? "" : "shape " + quoted(shape.name) + " " + fault;
}

}  // namespace

std::string fault_of(const WorldModel& model, const Shape& shape) {
  if (shape.surface.valid() && shape.surface.index() < model.surfaces.size())
    if (std::string fault = surface_fault(model.surfaces[shape.surface.index()]); !fault.empty())
      return fault;
  if (shape.mesh.valid() && shape.mesh.index() < model.meshes.size())
    if (std::string fault = mesh_fault(model.meshes[shape.mesh.index()]); !fault.empty()) return fault;
  return own_fault(model, shape);
}

std::string find_shape_fault(const WorldModel& model) {
  if (std::string fault = find_surface_and_mesh_fault(model); !fault.empty()) return fault;
  BodyId previous;
  for (const Shape& shape : model.shapes) {
    if (std::string fault = own_fault(model, shape); !fault.empty()) return fault;
    if (shape.body < previous) return "shape " + quoted(shape.name) + " is not in the order of the bodies";
    previous = shape.body;
  }
  return "";
}

}  // namespace visum::world

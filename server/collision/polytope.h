// A convex solid with flat faces: a box, the hull of points, a triangle. In its own frame; built once.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace visum::collision {

struct Polytope {
  struct Face {
    Eigen::Vector3d normal;   // unit, outwards
    std::uint32_t first = 0;  // into `corners`
    std::uint32_t count = 0;  // at least 3, counter-clockwise seen from outside
  };

  std::vector<Eigen::Vector3d> vertices;
  std::vector<Face> faces;
  std::vector<std::uint32_t> corners;                // vertices of the faces, face after face
  std::vector<Eigen::Vector3d> normals;              // directions of faces, distinct up to sign
  std::vector<Eigen::Vector3d> edges;                // directions of edges, distinct up to sign
  std::vector<std::vector<std::uint32_t>> faces_of;  // by vertex
  Eigen::Vector3d box = Eigen::Vector3d::Zero();     // of a box about its frame: half its lengths

  std::span<const std::uint32_t> corners_of(const Face& face) const {
    return std::span(corners).subspan(face.first, face.count);
  }
  std::uint32_t farthest(const Eigen::Vector3d& direction) const;
  // Of the faces that meet in the farthest vertex, the one that looks most along the direction.
  const Face& face_towards(const Eigen::Vector3d& direction) const;
};

// Fills `normals`, `edges` and `faces_of` from vertices, faces and corners.
void index_polytope(Polytope& polytope);

Polytope make_box(const Eigen::Vector3d& lengths);
// Two faces, back to back. set_triangle() moves the corners of one that stands, without allocating.
Polytope make_triangle();
void set_triangle(Polytope& triangle, const std::array<Eigen::Vector3d, 3>& corners,
                  const Eigen::Vector3d& normal);

}  // namespace visum::collision

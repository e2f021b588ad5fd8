// A convex solid with flat faces: a box, the hull of points, a triangle. Everything is in its own frame and
// built once.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace visum::collision {

// A pair is tested along all separating axes if neither solid has more directions of faces, or of edges: then
// there are at most 24 + 144.
inline constexpr std::size_t kMaxSatDirections = 12;

struct Polytope {
  struct Face {
    Eigen::Vector3d normal;   // unit, outwards
    std::uint32_t first = 0;  // index into `corners`
    std::uint32_t count = 0;  // at least 3, counter-clockwise seen from outside
  };

  std::vector<Eigen::Vector3d> vertices;
  std::vector<Face> faces;
  std::vector<std::uint32_t> corners;    // vertices of the faces, one face after the other
  std::vector<Eigen::Vector3d> normals;  // of the faces; a direction and its opposite count once. The first
                                         // kMaxSatDirections + 1 of them, since nobody looks along more
  std::vector<Eigen::Vector3d> edges;    // of the edges; likewise
  std::vector<std::vector<std::uint32_t>> faces_of;  // by vertex: the faces that meet there
  Eigen::Vector3d box =
      Eigen::Vector3d::Zero();  // half the lengths of a box about its frame; 0 for other solids

  std::span<const std::uint32_t> corners_of(const Face& face) const {
    return std::span(corners).subspan(face.first, face.count);
  }
  // The vertex that is farthest along a direction.
  std::uint32_t farthest(const Eigen::Vector3d& direction) const;
  // The face that looks most along the direction, of those that meet in the farthest vertex.
  const Face& face_towards(const Eigen::Vector3d& direction) const;
};

// Fills `normals`, `edges` and `faces_of` from vertices, faces and corners.
void index_polytope(Polytope& polytope);

Polytope make_box(const Eigen::Vector3d& lengths);
// Two faces, back to back. set_triangle() moves the corners of an existing one, without allocating.
Polytope make_triangle();
void set_triangle(Polytope& triangle, const std::array<Eigen::Vector3d, 3>& corners,
                  const Eigen::Vector3d& normal);

}  // namespace visum::collision

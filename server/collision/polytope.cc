#include "server/collision/polytope.h"

#include <cmath>

namespace visum::collision {
namespace {

constexpr double kSameDirection = 1.0 - 1e-9;

// Collects directions, each of which may stand for its opposite.
class Directions {
 public:
  explicit Directions(std::vector<Eigen::Vector3d>& directions) : directions_(directions) {}

  // Adds a direction, unless it or its opposite is there already, or there are too many.
  void add_distinct(const Eigen::Vector3d& unit) {
    if (directions_.size() > kMaxSatDirections) return;
    for (const Eigen::Vector3d& known : directions_)
      if (std::abs(known.dot(unit)) > kSameDirection) return;
    directions_.push_back(unit);
  }

 private:
  std::vector<Eigen::Vector3d>& directions_;
};

}  // namespace

std::uint32_t Polytope::farthest(const Eigen::Vector3d& direction) const {
  std::uint32_t best = 0;
  double most = direction.dot(vertices[0]);
  for (std::uint32_t i = 1; i < vertices.size(); ++i) {
    const double reach = direction.dot(vertices[i]);
    if (reach > most) {
      most = reach;
      best = i;
    }
  }
  return best;
}

const Polytope::Face& Polytope::face_towards(const Eigen::Vector3d& direction) const {
  const auto& candidates = faces_of[farthest(direction)];
  const Face* best = &faces[candidates[0]];
  for (const std::uint32_t i : candidates) {
    if (faces[i].normal.dot(direction) > best->normal.dot(direction)) best = &faces[i];
  }
  return *best;
}

void index_polytope(Polytope& polytope) {
  polytope.normals.clear();
  polytope.edges.clear();
  polytope.faces_of.assign(polytope.vertices.size(), {});
  for (auto& faces : polytope.faces_of) faces.reserve(8);
  Directions normals(polytope.normals), edges(polytope.edges);
  for (std::uint32_t f = 0; f < polytope.faces.size(); ++f) {
    const auto corners = polytope.corners_of(polytope.faces[f]);
    normals.add_distinct(polytope.faces[f].normal);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      polytope.faces_of[corners[i]].push_back(f);
      const Eigen::Vector3d& next = polytope.vertices[corners[(i + 1) % corners.size()]];
      edges.add_distinct((next - polytope.vertices[corners[i]]).normalized());
    }
  }
}

Polytope make_box(const Eigen::Vector3d& lengths) {
  Polytope box;
  box.box = 0.5 * lengths;
  for (int i = 0; i < 8; ++i)
    box.vertices.push_back(
        0.5 * lengths.cwiseProduct(Eigen::Vector3d(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  // Four corners for each face, counter-clockwise seen from outside.
  box.corners = {1, 3, 7, 5, 0, 4, 6, 2,   // +x -x
                 2, 6, 7, 3, 0, 1, 5, 4,   // +y -y
                 4, 5, 7, 6, 0, 2, 3, 1};  // +z -z
  for (std::uint32_t f = 0; f < 6; ++f) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(static_cast<Eigen::Index>(f / 2));
    box.faces.push_back({f % 2 == 0 ? axis : (-axis).eval(), 4 * f, 4});
  }
  index_polytope(box);
  return box;
}

Polytope make_triangle() {
  Polytope triangle;
  triangle.vertices = {Eigen::Vector3d::Zero(), Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()};
  triangle.corners = {0, 1, 2, 0, 2, 1};
  triangle.faces = {{Eigen::Vector3d::UnitZ(), 0, 3}, {-Eigen::Vector3d::UnitZ(), 3, 3}};
  triangle.normals.resize(1);
  triangle.edges.resize(3);
  triangle.faces_of.assign(3, {0, 1});
  return triangle;
}

void set_triangle(Polytope& triangle, const std::array<Eigen::Vector3d, 3>& corners,
                  const Eigen::Vector3d& normal) {
  for (std::size_t i = 0; i < 3; ++i) {
    triangle.vertices[i] = corners[i];
    triangle.edges[i] = (corners[(i + 1) % 3] - corners[i]).normalized();
  }
  triangle.faces[0].normal = normal;
  triangle.faces[1].normal = -normal;
  triangle.normals[0] = normal;
}

}  // namespace visum::collision

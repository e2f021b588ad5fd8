// Convex shapes as the narrow phase sees them, in the shape's own frame: the farthest point, face and edge in
// a direction. There are three families: solids with flat faces (box, hull, triangle), a cylinder, and a
// segment with a radius (sphere, capsule).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>

#include "server/collision/polytope.h"

namespace visum::collision {

inline constexpr std::size_t kMaxPolygon = 64;

// A few points, without allocation. A copy copies only the points that there are.
struct Polygon {
  std::array<Eigen::Vector3d, kMaxPolygon> points;
  std::size_t count = 0;

  Polygon() = default;
  Polygon(const Polygon& other) { *this = other; }
  Polygon& operator=(const Polygon& other) {
    count = other.count;
    std::copy_n(other.points.begin(), count, points.begin());
    return *this;
  }

  void add(const Eigen::Vector3d& point) {
    if (count < kMaxPolygon) points[count++] = point;
  }
};

// The part of a shape that a direction meets. Flat: at least three points around a normal. Otherwise one or
// two points, each the centre of a ball of `radius`; `normal` is then the direction in which this part looks
// best.
struct Feature {
  Polygon polygon;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit
  bool flat = false;
  double radius = 0.0;
};

enum class Family { kPolytope, kCylinder, kRound };

// One convex shape.
struct Convex {
  Family family = Family::kRound;
  Polytope polytope;         // only for this family
  double radius = 0.0;       // cylinder, round
  double half_length = 0.0;  // cylinder, round: along z
  double margin = 0.0;       // how far below its faces its core's are (penetration.h); 0 for round ones and
                             // triangles
  Eigen::Vector3d center = Eigen::Vector3d::Zero();

  Eigen::Vector3d farthest(const Eigen::Vector3d& direction) const;  // the direction is a unit vector
  Feature feature(const Eigen::Vector3d& direction) const;           // the face that touches
  Feature edge(const Eigen::Vector3d& direction) const;              // the edge or point that touches
};

Convex make_convex(Polytope polytope);
Convex make_cylinder(double radius, double length);
Convex make_round(double radius, double length);  // length 0: a sphere

}  // namespace visum::collision

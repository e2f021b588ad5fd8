// Makes contact points from a direction. Faces that look at each other are clipped against each other. Edges
// meet in one point or, if they are parallel, in two.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/collision/penetration.h"

namespace visum::collision {

// A contact point of one pair of shapes.
struct Point {
  Eigen::Vector3d p_W;       // midway between the surfaces
  Eigen::Vector3d normal_W;  // unit, from b to a
  double depth = 0.0;        // > 0
};

// Appends the contact points of two shapes that overlap along `direction`.
void add_manifold(const Placed& a, const Placed& b, const Direction& direction, std::vector<Point>& points);

// Appends only the points over a face whose normal is the direction. Returns false if there is none.
bool add_face_manifold(const Placed& a, const Placed& b, const Eigen::Vector3d& normal_W,
                       std::vector<Point>& points);

// Keeps at most `most` points from `first` on: the deepest, then again and again the one farthest from those
// kept. Points at the same place count once. Those kept stay in their order.
void reduce(std::vector<Point>& points, std::size_t first, std::size_t most);

}  // namespace visum::collision

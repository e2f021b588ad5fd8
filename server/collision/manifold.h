// From a direction to contact points: the faces that look at each other are clipped against each other, edges
// meet in one point or, where they are parallel, in two.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "server/collision/penetration.h"

namespace visum::collision {

struct Point {
  Eigen::Vector3d p_W;       // midway between the surfaces
  Eigen::Vector3d normal_W;  // unit, from b to a
  double depth = 0.0;        // > 0
};

// Appends the points of two shapes that overlap along `direction`.
void add_manifold(const Placed& a, const Placed& b, const Direction& direction, std::vector<Point>& points);

// Only what stands over a face whose normal is the direction; false where there is none.
bool add_face_manifold(const Placed& a, const Placed& b, const Eigen::Vector3d& normal_W,
                       std::vector<Point>& points);

// Keeps at most `most`: the deepest, then again and again the one farthest from those kept. Points that
// coincide count once. The order of those kept is that in which they came.
void reduce(std::vector<Point>& points, std::size_t first, std::size_t most);

}  // namespace visum::collision

// A triangle of a mesh as a convex shape. One of them is moved from place to place, so that no triangle of a
// mesh needs a shape of its own.
#pragma once

#include "server/collision/gjk.h"
#include "server/collision/shapes.h"

namespace visum::collision {

// Owned by those who compare meshes; tick's thread. place() allocates nothing.
class MovingTriangle {
 public:
  MovingTriangle() : convex_(make_convex(make_triangle())), gjk_(convex_) {}
  MovingTriangle(const MovingTriangle&) = delete;
  MovingTriangle& operator=(const MovingTriangle&) = delete;

  // The triangle at its mesh's place. Valid until the next call.
  Placed place(const PreparedShape& mesh, const MeshTriangle& triangle) {
    set_triangle(convex_.polytope, triangle.corners, triangle.normal);
    convex_.center = (triangle.corners[0] + triangle.corners[1] + triangle.corners[2]) / 3.0;
    gjk_.set_triangle(triangle.corners);
    return {&convex_, &gjk_, mesh.placed.R, mesh.placed.p};
  }

 private:
  Convex convex_;
  GjkShape gjk_;
};

}  // namespace visum::collision

// Finds the contact points of one pair of shapes, of any kinds.
#pragma once

#include <vector>

#include "server/collision/gjk.h"
#include "server/collision/manifold.h"
#include "server/collision/shapes.h"

namespace visum::collision {

// CollisionStage owns it; tick's thread. It holds FCL's memory, so that calls need none of their own.
class NarrowPhase {
 public:
  NarrowPhase();

  // At most kMaxContactsPerPair points, with normals from b to a. Valid until the next call. Does not
  // allocate once warm.
  const std::vector<Point>& find(const PreparedShape& a, const PreparedShape& b);
  // How far apart the two shapes of the last call are at least, m. 0 or less: they touch, or it is not known.
  double gap() const { return gap_; }

 private:
  // A triangle that is moved from one place of a mesh to the next.
  struct MovingTriangle {
    MovingTriangle();
    Placed place(const PreparedShape& mesh, const MeshTriangle& triangle);

    Convex convex;
    GjkShape gjk;
  };

  void find_with_plane(const PreparedShape& plane,
                       const PreparedShape& shape);                            // normals from plane to shape
  void find_with_mesh(const PreparedShape& mesh, const PreparedShape& shape);  // normals from mesh to shape
  void find_with_triangle(const Placed& convex, const Placed& placed, const Mesh& mesh,
                          const MeshTriangle& triangle);
  void find_meshes(const PreparedShape& a, const PreparedShape& b);
  // Adds a point with a radius, if it is below the plane.
  void add_below(const PreparedShape& plane, const Eigen::Vector3d& point_W, double radius);
  // Drops the points that matter least, once there are too many.
  void thin_out();

  GjkSolver solver_;
  MovingTriangle triangle_a_, triangle_b_;
  std::vector<Point> points_;
  double gap_ = 0.0;
};

}  // namespace visum::collision

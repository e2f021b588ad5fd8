// The contact points of one pair of shapes, whatever their kinds.
#pragma once

#include <vector>

#include "server/collision/gjk.h"
#include "server/collision/manifold.h"
#include "server/collision/shapes.h"

namespace visum::collision {

class NarrowPhase {
 public:
  NarrowPhase();

  // At most kMaxContactsPerPair points, normals from b to a. Valid until the next call. Does not allocate
  // once warm.
  const std::vector<Point>& find(const PreparedShape& a, const PreparedShape& b);
  // By how much at least the two of the last call are apart, m; 0 or less: they touch, or it is not known.
  double gap() const { return gap_; }

 private:
  // A triangle of a mesh, moved from one to the next.
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
  void add_below(const PreparedShape& plane, const Eigen::Vector3d& point_W, double radius);
  void thin_out();

  GjkSolver solver_;
  MovingTriangle triangle_a_, triangle_b_;
  std::vector<Point> points_;
  double gap_ = 0.0;
};

}  // namespace visum::collision

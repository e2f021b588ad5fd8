// Finds the contact points of one pair of shapes, of any kinds.
#pragma once

#include <vector>

#include "server/collision/gjk.h"
#include "server/collision/manifold.h"
#include "server/collision/moving_triangle.h"
#include "server/collision/shapes.h"
#include "server/collision/work.h"

namespace visum::collision {

// CollisionStage owns it; tick's thread. It holds FCL's memory, so that calls need none of their own.
class NarrowPhase {
 public:
  NarrowPhase();

  // At most kMaxContactsPerPair points, with normals from b to a. Valid until the next call. Does not
  // allocate once warm. A pair with a mesh that takes more work than `most` is looked at in a sample of the
  // mesh's triangles, for as much work again; is_limited() then tells so.
  const std::vector<Point>& find(const PreparedShape& a, const PreparedShape& b,
                                 std::uint64_t most = UINT64_MAX);
  bool is_limited() const { return limited_; }
  std::uint64_t work() const { return sampled_ + work_.taken(); }  // of the last call, in units of work.h
  // How far apart the two shapes of the last call are at least, m. 0 or less: they touch, or it is not known.
  double gap() const { return gap_; }

 private:
  // Calls each(triangle) for the triangles of a mesh for whose box meets(box) is true, or for a sample of
  // them.
  template <typename Meets, typename Each>
  void visit(const Mesh& mesh, Meets&& meets, Each&& each);
  void find_with_plane(const PreparedShape& plane,
                       const PreparedShape& shape);                            // normals from plane to shape
  void find_with_mesh(const PreparedShape& mesh, const PreparedShape& shape);  // normals from mesh to shape
  Direction find_with_triangle(const Placed& convex, const Placed& placed, const Mesh& mesh,
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
  PairWork work_;
  std::uint64_t most_ = UINT64_MAX, sampled_ = 0;  // sampled_: work before the sample
  bool limited_ = false;
};

}  // namespace visum::collision

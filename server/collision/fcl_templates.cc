// FCL's templates, compiled here for `double`: those that gjk.cc and fcl_stage.cc use. So no program links
// FCL's shared library, which has 29,000 symbols to bind at each start.
#include <fcl/broadphase/broadphase_SSaP.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/epa.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk.h>
#include <fcl/narrowphase/detail/gjk_solver_indep.h>

namespace fcl {

template class AABB<double>;
template class CollisionGeometry<double>;
template class ShapeBase<double>;
template class Box<double>;
template class Sphere<double>;
template class Capsule<double>;
template class Cylinder<double>;
template class Convex<double>;
template class TriangleP<double>;
template class CollisionObject<double>;
template class BroadPhaseCollisionManager<double>;
template class SSaPCollisionManager<double>;
template struct ContactPoint<double>;
template void flipNormal(std::vector<ContactPoint<double>>&);

namespace detail {

template struct Project<double>;
template struct MinkowskiDiff<double>;
template struct GJK<double>;
template struct EPA<double>;
template struct GJKSolver_indep<double>;
template void lineSegmentPointClosestToPoint(const Vector3<double>&, const Vector3<double>&,
                                             const Vector3<double>&, Vector3<double>&);
template void lineClosestApproach(const Vector3<double>&, const Vector3<double>&, const Vector3<double>&,
                                  const Vector3<double>&, double*, double*);
template int intersectRectQuad2(double*, double*, double*);
template void cullPoints2(int, double*, int, int, int*);
template int boxBox2(const Vector3<double>&, const Transform3<double>&, const Vector3<double>&,
                     const Transform3<double>&, Vector3<double>&, double*, int*, int,
                     std::vector<ContactPoint<double>>&);
template bool boxBoxIntersect(const Box<double>&, const Transform3<double>&, const Box<double>&,
                              const Transform3<double>&, std::vector<ContactPoint<double>>*);
template bool sphereBoxIntersect(const Sphere<double>&, const Transform3<double>&, const Box<double>&,
                                 const Transform3<double>&, std::vector<ContactPoint<double>>*);
template bool sphereSphereIntersect(const Sphere<double>&, const Transform3<double>&, const Sphere<double>&,
                                    const Transform3<double>&, std::vector<ContactPoint<double>>*);
template bool sphereCapsuleIntersect(const Sphere<double>&, const Transform3<double>&, const Capsule<double>&,
                                     const Transform3<double>&, std::vector<ContactPoint<double>>*);
template bool sphereCylinderIntersect(const Sphere<double>&, const Transform3<double>&,
                                      const Cylinder<double>&, const Transform3<double>&,
                                      std::vector<ContactPoint<double>>*);

}  // namespace detail
}  // namespace fcl

#include "server/collision/narrow_phase.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/collision/collision.h"

namespace visum::collision {
namespace {

// Points gathered of one pair before those that matter least are dropped.
constexpr std::size_t kMostGathered = 256;
constexpr std::size_t kLeftWhenThinned = 48;
// Work, in units of work.h: of two triangles, of a triangle with a convex shape and with each of its corners,
// of a point that is gathered (and later thinned out).
constexpr std::uint64_t kTwoTriangles = 60, kTriangle = 100, kPerCorner = 2, kPerPoint = 200;
// A sample has as many triangles as were done before the work was spent, or fewer.
constexpr std::uint64_t kLeastSample = 16;
constexpr double kSameNormal = 1.0 - 1e-6;
constexpr double kAtCornerM = 1e-6;
constexpr double kRiseSine = 1e-4;  // a smaller rise is rounding

// A box, parallel to the axes of the shape's frame, around a box in W.
Eigen::AlignedBox3d in_frame_of(const PreparedShape& frame, const Eigen::AlignedBox3d& box_W) {
  const Eigen::Matrix3d R = frame.placed.R.transpose();
  return box_around(box_W, R, -(R * frame.placed.p));
}

// Half-spaces that a convex shape does not reach, in a mesh's frame. They are found as the mesh is looked
// through.
class Unreached {
 public:
  // Triangles that are nearer to the shape than this are looked at in any case, m.
  static constexpr double kSkin = 1e-4;

  // Along `up_W` the shape begins above a part of the mesh.
  void add(const PreparedShape& mesh, const PreparedShape& shape, const Eigen::Vector3d& up_W) {
    const double lowest = up_W.dot(shape.placed.farthest(-up_W) - mesh.placed.p);
    spaces_[next_] = {mesh.placed.R.transpose() * up_W, lowest - kSkin};
    next_ = (next_ + 1) % spaces_.size();
    count_ = std::min(count_ + 1, spaces_.size());
  }
  bool holds(const Eigen::AlignedBox3d& box) const {
    return any([&](const Space& space) {
      return space.up.dot(box.center()) + space.up.cwiseAbs().dot(0.5 * box.sizes()) < space.below;
    });
  }
  bool holds(const std::array<Eigen::Vector3d, 3>& corners) const {
    return any([&](const Space& space) {
      return std::ranges::all_of(corners,
                                 [&](const auto& corner) { return space.up.dot(corner) < space.below; });
    });
  }

 private:
  struct Space {
    Eigen::Vector3d up;
    double below;
  };
  template <typename Holds>
  bool any(Holds&& holds) const {
    return std::any_of(spaces_.begin(), spaces_.begin() + static_cast<std::ptrdiff_t>(count_), holds);
  }

  std::array<Space, 8> spaces_;
  std::size_t count_ = 0, next_ = 0;
};

// The edge of the triangle that is nearest to a point.
std::size_t nearest_edge(const MeshTriangle& triangle, const Eigen::Vector3d& point) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d side = (triangle.corners[(i + 1) % 3] - triangle.corners[i]).normalized();
    const double distance = std::abs((point - triangle.corners[i]).dot(side.cross(triangle.normal)));
    if (distance >= least) continue;
    least = distance;
    best = i;
  }
  return best;
}

// True if a body can stand on an edge in this direction: the surface rises towards the body on neither side.
bool is_ridge(const MeshTriangle& triangle, std::size_t edge, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d side = (triangle.corners[(edge + 1) % 3] - triangle.corners[edge]).normalized();
  return direction.dot(triangle.normal.cross(side)) <= kRiseSine &&
         direction.dot(triangle.across[edge]) <= kRiseSine;
}

// The same for a corner: none of the edges that meet there rises.
bool is_peak(const Mesh& mesh, const Eigen::Vector3d& corner, const Eigen::Vector3d& direction) {
  bool peak = true;
  mesh.visit([&](const Eigen::AlignedBox3d& node) { return peak && node.contains(corner); },
             [&](std::uint32_t i) {
               const auto& corners = mesh.triangles()[i].corners;
               if (std::find(corners.begin(), corners.end(), corner) == corners.end()) return;
               for (const Eigen::Vector3d& other : corners)
                 peak &= direction.dot(other - corner) <= kRiseSine * (other - corner).norm();
             });
  return peak;
}

// True if a point on the triangle's border may push in a direction that is not the triangle's normal.
bool may_push(const Mesh& mesh, const MeshTriangle& triangle, const Eigen::Vector3d& point,
              const Eigen::Vector3d& direction) {
  const bool from_front = direction.dot(triangle.normal) > 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d& corner = triangle.corners[i];
    if ((point - corner).squaredNorm() > kAtCornerM * kAtCornerM) continue;
    return triangle.is_sharp(i) || triangle.is_sharp((i + 2) % 3) ||
           (from_front && is_peak(mesh, corner, direction));
  }
  const std::size_t edge = nearest_edge(triangle, point);
  return triangle.is_sharp(edge) || (from_front && is_ridge(triangle, edge, direction));
}

}  // namespace

NarrowPhase::NarrowPhase() {
  points_.reserve(2 * kMostGathered);
}

const std::vector<Point>& NarrowPhase::find(const PreparedShape& a, const PreparedShape& b,
                                            std::uint64_t most) {
  using enum world::ShapeKind;
  points_.clear();
  work_.start(most);
  most_ = most;
  sampled_ = 0;
  limited_ = false;
  gap_ = 0.0;
  // A plane or mesh gives normals from itself to the other shape: they are turned if it is a.
  const auto turn = [this] {
    for (Point& point : points_) point.normal_W = -point.normal_W;
  };
  if (b.kind == kPlane) {
    find_with_plane(b, a);
  } else if (a.kind == kPlane) {
    find_with_plane(a, b);
    turn();
  } else if (a.kind == kMesh && b.kind == kMesh) {
    find_meshes(a, b);
  } else if (b.kind == kMesh) {
    find_with_mesh(b, a);
  } else if (a.kind == kMesh) {
    find_with_mesh(a, b);
    turn();
  } else {
    const Direction direction = find_direction(a.placed, b.placed, solver_);
    if (!direction.apart) add_manifold(a.placed, b.placed, direction, points_);
    gap_ = direction.gap;
  }
  reduce(points_, 0, kMaxContactsPerPair);
  return points_;
}

// The triangles stand in the order of the tree, so equal steps through their list spread over the mesh.
template <typename Meets, typename Each>
void NarrowPhase::visit(const Mesh& mesh, Meets&& meets, Each&& each) {
  std::uint64_t done = 0;
  const auto look = [&](const Eigen::AlignedBox3d& node) {
    work_.take(1);
    return !work_.is_spent() && meets(node);
  };
  mesh.visit(look, [&](std::uint32_t i) {
    if (work_.is_spent()) return;
    each(mesh.triangles()[i]);
    ++done;
  });
  if (!work_.is_spent()) return;
  limited_ = true;
  sampled_ = work_.taken();
  work_.start(most_);
  const std::uint64_t size = mesh.triangles().size();
  const std::uint64_t step = std::max<std::uint64_t>(1, size / std::max(done, kLeastSample));
  for (std::uint64_t i = step / 2; i < size && !work_.is_spent(); i += step) {
    const MeshTriangle& triangle = mesh.triangles()[i];
    work_.take(1);
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& corner : triangle.corners) box.extend(corner);
    if (meets(box)) each(triangle);
  }
}

void NarrowPhase::add_below(const PreparedShape& plane, const Eigen::Vector3d& point_W, double radius) {
  const Eigen::Vector3d normal = plane.placed.R.col(2);
  const double height = normal.dot(point_W - plane.placed.p) - radius;
  if (height >= 0.0) return;
  points_.push_back({point_W - (radius + 0.5 * height) * normal, normal, -height});
  thin_out();
}

// All corners of a solid below the plane count, not only those of one face.
void NarrowPhase::find_with_plane(const PreparedShape& plane, const PreparedShape& shape) {
  const Placed& placed = shape.placed;
  if (shape.mesh != nullptr) {
    const Eigen::Vector3d normal = placed.R.transpose() * plane.placed.R.col(2);
    const double offset = plane.placed.R.col(2).dot(plane.placed.p - placed.p);
    const auto below = [&](const Eigen::AlignedBox3d& box) {
      return normal.dot(box.center()) - normal.cwiseAbs().dot(0.5 * box.sizes()) < offset;
    };
    visit(*shape.mesh, below, [&](const MeshTriangle& triangle) {
      work_.take(3 * kPerPoint);
      for (const Eigen::Vector3d& corner : triangle.corners)
        add_below(plane, placed.p + placed.R * corner, 0.0);
    });
  } else if (const Convex& convex = shape.solid->convex; convex.family == Family::kPolytope) {
    for (const Eigen::Vector3d& vertex : convex.polytope.vertices)
      add_below(plane, placed.p + placed.R * vertex, 0.0);
  } else {
    const Feature feature = convex.feature(placed.R.transpose() * -plane.placed.R.col(2));
    for (std::size_t i = 0; i < feature.polygon.count; ++i)
      add_below(plane, placed.p + placed.R * feature.polygon.points[i], feature.radius);
  }
}

// Where one triangle is apart from the shape, so are most of its neighbours, and by the same plane.
void NarrowPhase::find_with_mesh(const PreparedShape& mesh, const PreparedShape& shape) {
  const Eigen::AlignedBox3d box = in_frame_of(mesh, shape.box_W);
  const std::uint64_t look = kTriangle + kPerCorner * shape.solid->convex.polytope.vertices.size();
  Unreached unreached;
  visit(
      *mesh.mesh,
      [&](const Eigen::AlignedBox3d& node) { return node.intersects(box) && !unreached.holds(node); },
      [&](const MeshTriangle& triangle) {
        if (unreached.holds(triangle.corners)) return;
        const std::size_t before = points_.size();
        const Direction direction =
            find_with_triangle(shape.placed, triangle_a_.place(mesh, triangle), *mesh.mesh, triangle);
        if (direction.apart && direction.gap > Unreached::kSkin && !direction.normal_W.isZero(0.0))
          unreached.add(mesh, shape, direction.normal_W);
        work_.take(look + kPerPoint * (points_.size() - before));
        thin_out();
      });
}

// A triangle pushes sideways only over a sharp edge, or where a body stands on the edge or corner itself.
// Elsewhere the surface goes on. The triangle then pushes what is above it along its own normal, and leaves
// the rest to its neighbour.
Direction NarrowPhase::find_with_triangle(const Placed& convex, const Placed& placed, const Mesh& mesh,
                                          const MeshTriangle& triangle) {
  const Direction direction = find_direction(convex, placed, solver_);
  if (direction.apart) return direction;
  const std::size_t first = points_.size();
  add_manifold(convex, placed, direction, points_);
  const Eigen::Vector3d up = placed.R * triangle.normal;
  // Pushing along the triangle's own normal is always right.
  if (std::abs(direction.normal_W.dot(up)) >= kSameNormal) return direction;
  const Point& last = points_.back();
  const Eigen::Vector3d on_triangle_W = last.p_W + 0.5 * last.depth * last.normal_W;
  if (may_push(mesh, triangle, placed.R.transpose() * (on_triangle_W - placed.p),
               placed.R.transpose() * direction.normal_W))
    return direction;
  // Otherwise these points go. A body in front gets the points over the face instead.
  points_.resize(first);
  const bool in_front = up.dot(convex.center() - placed.farthest(up)) >= 0.0;
  if (in_front) add_face_manifold(convex, placed, up, points_);
  return direction;
}

void NarrowPhase::find_meshes(const PreparedShape& a, const PreparedShape& b) {
  // Only triangles within the common part of both boxes can meet.
  const Eigen::AlignedBox3d shared_W = a.box_W.intersection(b.box_W);
  const Eigen::AlignedBox3d shared = in_frame_of(a, shared_W);
  const auto meets_shared = [&](const Eigen::AlignedBox3d& node) { return node.intersects(shared); };
  visit(*a.mesh, meets_shared, [&](const MeshTriangle& triangle) {
    const Placed placed_a = triangle_a_.place(a, triangle);
    Eigen::AlignedBox3d box_W;
    for (const Eigen::Vector3d& corner : triangle.corners) box_W.extend(placed_a.p + placed_a.R * corner);
    const Eigen::AlignedBox3d box = in_frame_of(b, box_W);
    const auto meets = [&](const Eigen::AlignedBox3d& node) {
      work_.take(1);
      return !work_.is_spent() && node.intersects(box);
    };
    b.mesh->visit(meets, [&](std::uint32_t j) {
      if (work_.is_spent()) return;
      const Placed placed_b = triangle_b_.place(b, b.mesh->triangles()[j]);
      const Direction direction = find_direction(placed_a, placed_b, solver_);
      const std::size_t before = points_.size();
      if (!direction.apart) add_manifold(placed_a, placed_b, direction, points_);
      work_.take(kTwoTriangles + kPerPoint * (points_.size() - before));
      thin_out();
    });
  });
}

void NarrowPhase::thin_out() {
  if (points_.size() > kMostGathered) reduce(points_, 0, kLeftWhenThinned);
}

}  // namespace visum::collision

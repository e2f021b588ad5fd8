#include "server/collision/gjk.h"

#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/epa.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk.h>

#include <algorithm>

namespace visum::collision {
namespace {

using ShapePtr = std::unique_ptr<fcl::ShapeBased>;

// FCL compares squared lengths in m² with this: support points within a micrometre count as one.
constexpr double kGjkTolerance = 1e-12;
constexpr unsigned kGjkIterations = 128;
constexpr unsigned kEpaFaces = 256;
constexpr unsigned kEpaVertices = 128;
constexpr unsigned kEpaIterations = 255;
constexpr double kEpaTolerance = 1e-6;

constexpr double kDepthSlackM = 1e-5;  // m, by which EPA's depth may be wrong
constexpr int kInsetSweeps = 32;
constexpr double kInsetSlack = 1e-9;  // share of the margin
// The answer of the cores counts as long as their skin adds no more than this many margins; at a box's corner
// it is sqrt(3).
constexpr double kMostSkin = 2.0;

// Moves a vertex to `margin` below all faces, and not much farther: onto the inner plane of one face after
// the other. The rest, at a sharp tip, is done towards the centre, which lies ten margins below all faces.
Eigen::Vector3d inset(const Convex& convex, Eigen::Vector3d vertex, double margin) {
  const Polytope& polytope = convex.polytope;
  double most = margin;
  for (int sweep = 0; sweep < kInsetSweeps && most > 0.0; ++sweep) {
    most = 0.0;
    for (const Polytope::Face& face : polytope.faces) {
      const double excess =
          face.normal.dot(vertex - polytope.vertices[polytope.corners[face.first]]) + margin;
      if (excess <= kInsetSlack * margin) continue;
      vertex -= excess * face.normal;
      most = std::max(most, excess);
    }
  }
  return convex.center + 9.0 * margin / (9.0 * margin + most) * (vertex - convex.center);
}

// A solid whose faces are all moved back by `margin`.
ShapePtr make_fcl_polytope(const Convex& convex, double margin) {
  const Polytope& polytope = convex.polytope;
  auto vertices = std::make_shared<std::vector<Eigen::Vector3d>>(polytope.vertices);
  if (margin > 0.0) {
    for (Eigen::Vector3d& vertex : *vertices) vertex = inset(convex, vertex, margin);
  }
  auto faces = std::make_shared<std::vector<int>>();
  for (const Polytope::Face& face : polytope.faces) {
    faces->push_back(static_cast<int>(face.count));
    for (const std::uint32_t corner : polytope.corners_of(face)) faces->push_back(static_cast<int>(corner));
  }
  return std::make_unique<fcl::Convexd>(vertices, static_cast<int>(polytope.faces.size()), faces);
}

ShapePtr make_fcl_shape(const Convex& convex, double margin) {
  switch (convex.family) {
    case Family::kPolytope:
      return make_fcl_polytope(convex, margin);
    case Family::kCylinder:
      return std::make_unique<fcl::Cylinderd>(convex.radius - margin, 2.0 * (convex.half_length - margin));
    case Family::kRound:
      break;
  }
  // For round shapes the radius is the margin, so the core is a point or a segment.
  if (convex.half_length == 0.0) return std::make_unique<fcl::Sphered>(0.0);
  return std::make_unique<fcl::Capsuled>(0.0, 2.0 * convex.half_length);
}

}  // namespace

struct GjkShape::Impl {
  ShapePtr full, core;
  fcl::TrianglePd* triangle = nullptr;  // null, or `full` as a triangle
};

GjkShape::GjkShape(const Convex& convex) : impl_(std::make_unique<Impl>()) {
  const bool is_triangle = convex.family == Family::kPolytope && convex.polytope.vertices.size() == 3;
  if (is_triangle) {
    const auto& corners = convex.polytope.vertices;
    auto triangle = std::make_unique<fcl::TrianglePd>(corners[0], corners[1], corners[2]);
    impl_->triangle = triangle.get();
    impl_->full = std::move(triangle);
  } else {
    impl_->full = make_fcl_shape(convex, 0.0);
    impl_->core = make_fcl_shape(convex, convex.margin);
  }
}

GjkShape::~GjkShape() = default;
GjkShape::GjkShape(GjkShape&&) noexcept = default;

void GjkShape::set_triangle(const std::array<Eigen::Vector3d, 3>& corners) {
  impl_->triangle->a = corners[0];
  impl_->triangle->b = corners[1];
  impl_->triangle->c = corners[2];
}

struct GjkSolver::Impl {
  fcl::detail::GJKd gjk{kGjkIterations, kGjkTolerance};
  fcl::detail::EPAd epa{kEpaFaces, kEpaVertices, kEpaIterations, kEpaTolerance};

  struct Found {
    Eigen::Vector3d unit;
    double depth;  // of the given shapes; negative: apart
  };
  std::optional<Found> find(const Placed& a, const fcl::ShapeBased& shape_a, const Placed& b,
                            const fcl::ShapeBased& shape_b);
};

GjkSolver::GjkSolver() : impl_(std::make_unique<Impl>()) {}
GjkSolver::~GjkSolver() = default;

// GJK for shapes that are apart, EPA for shapes that overlap.
std::optional<GjkSolver::Impl::Found> GjkSolver::Impl::find(const Placed& a, const fcl::ShapeBased& shape_a,
                                                            const Placed& b, const fcl::ShapeBased& shape_b) {
  using fcl::detail::EPAd;
  using fcl::detail::GJKd;
  fcl::detail::MinkowskiDiffd difference;
  difference.shapes[0] = &shape_a;
  difference.shapes[1] = &shape_b;
  difference.toshape1 = b.R.transpose() * a.R;
  difference.toshape0.linear() = a.R.transpose() * b.R;
  difference.toshape0.translation() = a.R.transpose() * (b.p - a.p);
  difference.toshape0.makeAffine();
  const Eigen::Vector3d guess = a.R.transpose() * (a.center() - b.center());
  const GJKd::Status status = gjk.evaluate(difference, guess);
  if (status == GJKd::Valid && gjk.distance > 0.0) return Found{a.R * gjk.ray.normalized(), -gjk.distance};
  if (status != GJKd::Inside || epa.evaluate(gjk, guess) == EPAd::Failed) return std::nullopt;
  const Eigen::Vector3d normal = a.R * epa.normal;
  if (!normal.allFinite() || normal.squaredNorm() < 0.5) return std::nullopt;
  const Eigen::Vector3d unit = normal.normalized();
  const bool turned = overlap_along(a, b, unit) > overlap_along(a, b, -unit);
  return Found{turned ? (-unit).eval() : unit, epa.depth};
}

std::optional<Eigen::Vector3d> GjkSolver::separating_direction(const Placed& a, const Placed& b) {
  const GjkShape::Impl &shapes_a = a.gjk->impl(), &shapes_b = b.gjk->impl();
  // A round shape has a margin of its own; the other shape then takes part as it is.
  const bool round = a.convex->family == Family::kRound || b.convex->family == Family::kRound;
  const auto pick = [&](const Placed& side) -> const fcl::ShapeBased& {
    const GjkShape::Impl& shapes = side.gjk->impl();
    const bool core = side.convex->family == Family::kRound || (!round && shapes.core != nullptr);
    return core ? *shapes.core : *shapes.full;
  };
  const auto by_cores = impl_->find(a, pick(a), b, pick(b));
  if (round) return by_cores ? std::optional(by_cores->unit) : std::nullopt;
  // At a sharp tip the skin is thick, and the cores may lie differently than the shapes do.
  const double most_skin = kMostSkin * (a.convex->margin + b.convex->margin);
  const auto overlap = [&](const Impl::Found& found) { return overlap_along(a, b, found.unit); };
  if (by_cores && overlap(*by_cores) <= by_cores->depth + most_skin + kDepthSlackM) return by_cores->unit;
  const auto by_shapes = impl_->find(a, *shapes_a.full, b, *shapes_b.full);
  if (!by_shapes) return by_cores ? std::optional(by_cores->unit) : std::nullopt;
  return by_cores && overlap(*by_cores) < overlap(*by_shapes) ? by_cores->unit : by_shapes->unit;
}

}  // namespace visum::collision

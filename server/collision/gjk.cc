#include "server/collision/gjk.h"

#include <fcl/geometry/shape/capsule.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/geometry/shape/cylinder.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/geometry/shape/triangle_p.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/epa.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk.h>

#include <variant>

namespace visum::collision {
namespace {

using ShapePtr = std::unique_ptr<fcl::ShapeBased>;

// FCL compares squared lengths in m² with this: support points within a micrometre are one.
constexpr double kGjkTolerance = 1e-12;
constexpr unsigned kGjkIterations = 128;
constexpr unsigned kEpaFaces = 256;
constexpr unsigned kEpaVertices = 128;
constexpr unsigned kEpaIterations = 255;
constexpr double kEpaTolerance = 1e-6;

// A solid shrunk towards its centre so far that its nearest face goes back by `margin`.
ShapePtr make_fcl_polytope(const Convex& convex, double margin) {
  const Polytope& polytope = convex.polytope;
  double inner = std::numeric_limits<double>::infinity();
  for (const Polytope::Face& face : polytope.faces)
    inner = std::min(inner, face.normal.dot(polytope.vertices[polytope.corners[face.first]] - convex.center));
  const double scale = margin > 0.0 ? 1.0 - margin / inner : 1.0;
  auto vertices = std::make_shared<std::vector<Eigen::Vector3d>>();
  for (const auto& vertex : polytope.vertices)
    vertices->push_back(convex.center + scale * (vertex - convex.center));
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
  // The radius is the margin: the core is a point or a segment.
  if (convex.half_length == 0.0) return std::make_unique<fcl::Sphered>(0.0);
  return std::make_unique<fcl::Capsuled>(0.0, 2.0 * convex.half_length);
}

}  // namespace

struct GjkShape::Impl {
  ShapePtr full, core;
  fcl::TrianglePd* triangle = nullptr;  // of those: `full`
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
};

GjkSolver::GjkSolver() : impl_(std::make_unique<Impl>()) {}
GjkSolver::~GjkSolver() = default;

std::optional<Eigen::Vector3d> GjkSolver::separating_direction(const Placed& a, const Placed& b) {
  using fcl::detail::EPAd;
  using fcl::detail::GJKd;
  // A round shape brings a margin of its own; then the other one takes part as it is.
  const bool round = a.convex->family == Family::kRound || b.convex->family == Family::kRound;
  const auto pick = [&](const Placed& side) {
    const GjkShape::Impl& shapes = side.gjk->impl();
    const bool core = side.convex->family == Family::kRound || (!round && shapes.core != nullptr);
    return core ? shapes.core.get() : shapes.full.get();
  };
  fcl::detail::MinkowskiDiffd difference;
  difference.shapes[0] = pick(a);
  difference.shapes[1] = pick(b);
  difference.toshape1 = b.R.transpose() * a.R;
  difference.toshape0.linear() = a.R.transpose() * b.R;
  difference.toshape0.translation() = a.R.transpose() * (b.p - a.p);
  difference.toshape0.makeAffine();
  const Eigen::Vector3d guess = a.R.transpose() * (a.center() - b.center());
  const GJKd::Status status = impl_->gjk.evaluate(difference, guess);
  if (status == GJKd::Valid && impl_->gjk.distance > 0.0) return a.R * impl_->gjk.ray.normalized();
  if (status != GJKd::Inside || impl_->epa.evaluate(impl_->gjk, guess) == EPAd::Failed) return std::nullopt;
  const Eigen::Vector3d normal = a.R * impl_->epa.normal;
  if (!normal.allFinite() || normal.squaredNorm() < 0.5) return std::nullopt;
  const Eigen::Vector3d unit = normal.normalized();
  return overlap_along(a, b, unit) <= overlap_along(a, b, -unit) ? unit : (-unit).eval();
}

}  // namespace visum::collision

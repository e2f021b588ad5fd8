#include "server/collision/convex.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace visum::collision {
namespace {

constexpr double kLargestMarginM = 1e-3;
constexpr double kMarginShare = 0.1;  // of the distance from the middle to the nearest face
constexpr double kCapCosine = 0.7;    // a cylinder offers its cap if it looks within 45° of the direction
constexpr double kUprightSine = 1e-6;
constexpr double kEdgeSine = 0.02;           // an edge that leans more than this touches with its end
constexpr std::size_t kMaxFaceCorners = 32;  // of a hull's face that take part; clipping at most doubles them

// Margin of a core, from the distance of the middle to the nearest face.
double margin_for(double inner_radius) {
  return std::min(kLargestMarginM, kMarginShare * inner_radius);
}

Eigen::Vector3d mean(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

// The unit direction across z; x for a direction along z.
Eigen::Vector3d radial(const Eigen::Vector3d& direction) {
  const double length = direction.head<2>().norm();
  if (length == 0.0) return Eigen::Vector3d::UnitX();
  return {direction.x() / length, direction.y() / length, 0.0};
}

// The face that looks most along the direction, with at most kMaxFaceCorners corners.
Feature polytope_face(const Polytope& polytope, const Eigen::Vector3d& direction) {
  const Polytope::Face& face = polytope.face_towards(direction);
  const auto corners = polytope.corners_of(face);
  Feature feature;
  const std::size_t count = std::min<std::size_t>(corners.size(), kMaxFaceCorners);
  for (std::size_t i = 0; i < count; ++i)
    feature.polygon.add(
        polytope.vertices[corners[i * corners.size() / count]]);  // evenly, where there are too many
  feature.normal = face.normal;
  feature.flat = true;
  return feature;
}

// The farthest vertex, with the neighbour whose edge to it leans least.
Feature polytope_edge(const Polytope& polytope, const Eigen::Vector3d& direction) {
  const std::uint32_t tip = polytope.farthest(direction);
  const Eigen::Vector3d& p = polytope.vertices[tip];
  Feature feature;
  feature.polygon.add(p);
  feature.normal = direction;
  double least = kEdgeSine;
  for (const std::uint32_t f : polytope.faces_of[tip]) {
    const auto corners = polytope.corners_of(polytope.faces[f]);
    const auto at =
        static_cast<std::size_t>(std::find(corners.begin(), corners.end(), tip) - corners.begin());
    if (at == corners.size()) continue;
    const Eigen::Vector3d& next = polytope.vertices[corners[(at + 1) % corners.size()]];
    const double lean = direction.dot(p - next) / (p - next).norm();
    if (lean >= least) continue;
    least = lean;
    feature.polygon.count = 1;
    feature.polygon.add(next);
  }
  return feature;
}

// Written out, because the C library's sine may have other bits on another processor.
constexpr double kHalfRoot = std::numbers::sqrt2 / 2.0;
constexpr std::array<std::array<double, 2>, 8> kRim{{{1, 0},
                                                     {kHalfRoot, kHalfRoot},
                                                     {0, 1},
                                                     {-kHalfRoot, kHalfRoot},
                                                     {-1, 0},
                                                     {-kHalfRoot, -kHalfRoot},
                                                     {0, -1},
                                                     {kHalfRoot, -kHalfRoot}}};

// True if a direction lies between two corners of the rim.
bool is_between(const std::array<double, 2>& from, const Eigen::Vector3d& direction,
                const std::array<double, 2>& to) {
  return from[0] * direction.y() - from[1] * direction.x() >= 0.0 &&
         direction.x() * to[1] - direction.y() * to[0] > 0.0;
}

// The cap as a polygon of fixed corners, plus the lowest point of the rim between them. A cylinder that
// stands thus stands on corners that do not wander, and one that leans rolls on its true rim.
Feature cylinder_cap(const Convex& cylinder, const Eigen::Vector3d& direction) {
  const double side = direction.z() >= 0.0 ? 1.0 : -1.0;
  const Eigen::Vector3d middle(0, 0, side * cylinder.half_length);
  const bool leans = direction.head<2>().norm() > kUprightSine;
  Feature feature;
  for (std::size_t i = 0; i < kRim.size(); ++i) {
    const auto& corner = kRim[i];
    const auto& next = kRim[(i + 1) % kRim.size()];
    feature.polygon.add(middle + cylinder.radius * Eigen::Vector3d(corner[0], corner[1], 0.0));
    if (leans && is_between(corner, direction, next))
      feature.polygon.add(middle + cylinder.radius * radial(direction));
  }
  if (side < 0.0)
    std::reverse(feature.polygon.points.begin(),
                 feature.polygon.points.begin() + static_cast<std::ptrdiff_t>(feature.polygon.count));
  feature.normal = {0.0, 0.0, side};
  feature.flat = true;
  return feature;
}

// The line on the side that is farthest along the direction.
Feature cylinder_side(const Convex& cylinder, const Eigen::Vector3d& direction) {
  Feature feature;
  feature.normal = radial(direction);
  for (const double side : {1.0, -1.0})
    feature.polygon.add(cylinder.radius * feature.normal +
                        Eigen::Vector3d(0, 0, side * cylinder.half_length));
  return feature;
}

Feature round_segment(const Convex& round, const Eigen::Vector3d& direction) {
  Feature feature;
  feature.normal = direction;
  feature.radius = round.radius;
  feature.polygon.add({0, 0, round.half_length});
  if (round.half_length > 0.0) feature.polygon.add({0, 0, -round.half_length});
  return feature;
}

}  // namespace

Eigen::Vector3d Convex::farthest(const Eigen::Vector3d& direction) const {
  const Eigen::Vector3d end(0, 0, direction.z() >= 0.0 ? half_length : -half_length);
  switch (family) {
    case Family::kPolytope:
      return polytope.vertices[polytope.farthest(direction)];
    case Family::kCylinder:
      return end + radius * radial(direction);
    case Family::kRound:
      break;
  }
  return end + radius * direction;
}

Feature Convex::feature(const Eigen::Vector3d& direction) const {
  if (family == Family::kPolytope) return polytope_face(polytope, direction);
  if (family == Family::kRound) return round_segment(*this, direction);
  return std::abs(direction.z()) > kCapCosine ? cylinder_cap(*this, direction)
                                              : cylinder_side(*this, direction);
}

Feature Convex::edge(const Eigen::Vector3d& direction) const {
  if (family == Family::kPolytope) return polytope_edge(polytope, direction);
  if (family == Family::kRound) return round_segment(*this, direction);
  if (std::abs(direction.z()) <= kEdgeSine) return cylinder_side(*this, direction);
  Feature rim;
  rim.normal = direction;
  rim.polygon.add(farthest(direction));
  return rim;
}

Convex make_convex(Polytope polytope) {
  Convex convex;
  convex.family = Family::kPolytope;
  convex.center = mean(polytope.vertices);
  // The margin follows from the face that is nearest to the middle.
  double inner = kLargestMarginM / kMarginShare;
  for (const Polytope::Face& face : polytope.faces) {
    const Eigen::Vector3d& on_face = polytope.vertices[polytope.corners[face.first]];
    inner = std::min(inner, face.normal.dot(on_face - convex.center));
  }
  convex.margin = margin_for(std::max(inner, 0.0));
  convex.polytope = std::move(polytope);
  return convex;
}

Convex make_cylinder(double radius, double length) {
  Convex convex;
  convex.family = Family::kCylinder;
  convex.radius = radius;
  convex.half_length = 0.5 * length;
  convex.margin = margin_for(std::min(radius, convex.half_length));
  return convex;
}

Convex make_round(double radius, double length) {
  Convex convex;
  convex.radius = radius;
  convex.half_length = 0.5 * length;
  return convex;
}

}  // namespace visum::collision

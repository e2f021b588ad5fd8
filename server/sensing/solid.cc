#include "server/sensing/solid.h"

#include <cmath>
#include <tuple>

#include "server/collision/hull.h"

namespace visum::sensing {
namespace {

using Eigen::Vector3d;

constexpr double kNever = std::numeric_limits<double>::infinity();

Passage miss() {
  return {kNever, -kNever};
}

// Cuts off the part of the passage that lies outside of a half-space.
void clip(Passage& passage, const HalfSpace& half, const Vector3d& p, const Vector3d& d) {
  const double speed = half.normal.dot(d);
  const double ahead = half.offset - half.normal.dot(p);
  if (speed == 0.0) {
    if (ahead < 0.0) passage = miss();
    return;
  }
  const double t = ahead / speed;
  if (speed > 0.0 && t < passage.out) {
    passage.out = t;
    passage.normal_out = half.normal;
  } else if (speed < 0.0 && t > passage.in) {
    passage.in = t;
    passage.normal_in = half.normal;
  }
}

// Passes through |x - center| <= radius. Only the components with a 1 in `mask` count: all make a ball, x and
// y a bar. Uses m, the point of the line nearest to the centre: |m + s d|² = radius² suffers no cancellation.
Passage pass_round(const Vector3d& mask, double radius, const Vector3d& from_center, const Vector3d& d) {
  const Vector3d flat_d = mask.cwiseProduct(d), flat_p = mask.cwiseProduct(from_center);
  const double square = flat_d.squaredNorm();
  if (square == 0.0) return flat_p.norm() <= radius ? Passage{} : miss();
  const double nearest = -flat_p.dot(flat_d) / square;
  const Vector3d m = flat_p + nearest * flat_d;
  const double left = radius * radius - m.squaredNorm();
  if (left < 0.0) return miss();
  const double half = std::sqrt(left / square);
  return {nearest - half, nearest + half, (m - half * flat_d) / radius, (m + half * flat_d) / radius};
}

const Vector3d kAll(1, 1, 1), kAcross(1, 1, 0);

// The union of two passages, for solids whose union is convex.
Passage joined(const Passage& a, const Passage& b) {
  if (a.in > a.out) return b;
  if (b.in > b.out) return a;
  Passage both = a;
  if (b.in < both.in) std::tie(both.in, both.normal_in) = std::tie(b.in, b.normal_in);
  if (b.out > both.out) std::tie(both.out, both.normal_out) = std::tie(b.out, b.normal_out);
  return both;
}

Passage pass_capsule(const Solid& solid, const Vector3d& p, const Vector3d& d) {
  const Vector3d up = solid.half_length * Vector3d::UnitZ();
  Passage bar = pass_round(kAcross, solid.radius, p, d);
  clip(bar, {Vector3d::UnitZ(), solid.half_length}, p, d);
  clip(bar, {-Vector3d::UnitZ(), solid.half_length}, p, d);
  const Passage top = pass_round(kAll, solid.radius, p - up, d);
  const Passage bottom = pass_round(kAll, solid.radius, p + up, d);
  return joined(bar, joined(top, bottom));
}

void set_box(Solid& solid, const Vector3d& half) {
  solid.low = -half;
  solid.high = half;
}

void add_slab(Solid& solid, int axis, double half) {
  solid.faces.push_back({Vector3d::Unit(axis), half});
  solid.faces.push_back({-Vector3d::Unit(axis), half});
}

void set_hull(Solid& solid, const std::vector<Vector3d>& points) {
  const collision::Polytope hull = collision::make_hull(points);
  for (const auto& face : hull.faces) {
    const Vector3d& corner = hull.vertices[hull.corners_of(face).front()];
    solid.faces.push_back({face.normal, face.normal.dot(corner)});
  }
  solid.low = solid.high = hull.vertices.front();
  for (const Vector3d& vertex : hull.vertices) {
    solid.low = solid.low.cwiseMin(vertex);
    solid.high = solid.high.cwiseMax(vertex);
  }
}

}  // namespace

Solid make_solid(const world::WorldModel& model, const world::Shape& shape) {
  Solid solid;
  solid.radius = shape.size[0];
  solid.half_length = shape.size[1] / 2;
  const double r = solid.radius, h = solid.half_length;
  switch (shape.kind) {
    case world::ShapeKind::kBox:
      for (int axis = 0; axis < 3; ++axis)
        add_slab(solid, axis, shape.size[static_cast<std::size_t>(axis)] / 2);
      set_box(solid, Vector3d(shape.size[0], shape.size[1], shape.size[2]) / 2);
      break;
    case world::ShapeKind::kSphere:
      solid.round = Solid::Round::kBall;
      set_box(solid, Vector3d(r, r, r));
      break;
    case world::ShapeKind::kCylinder:
      solid.round = Solid::Round::kBar;
      add_slab(solid, 2, h);
      set_box(solid, Vector3d(r, r, h));
      break;
    case world::ShapeKind::kCapsule:
      solid.round = Solid::Round::kCapsule;
      set_box(solid, Vector3d(r, r, h + r));
      break;
    case world::ShapeKind::kPlane:
      solid.faces.push_back({Vector3d::UnitZ(), 0.0});
      break;
    case world::ShapeKind::kConvex:
      set_hull(solid, model.meshes[shape.mesh.index()].vertices);
      break;
    case world::ShapeKind::kMesh:
      break;
  }
  return solid;
}

Passage pass_through(const Solid& solid, const Vector3d& p, const Vector3d& d) {
  Passage passage;
  if (solid.round == Solid::Round::kBall) passage = pass_round(kAll, solid.radius, p, d);
  if (solid.round == Solid::Round::kBar) passage = pass_round(kAcross, solid.radius, p, d);
  if (solid.round == Solid::Round::kCapsule) passage = pass_capsule(solid, p, d);
  for (const HalfSpace& face : solid.faces) clip(passage, face, p, d);
  return passage;
}

}  // namespace visum::sensing

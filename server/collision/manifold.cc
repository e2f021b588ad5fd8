#include "server/collision/manifold.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "server/collision/segments.h"

namespace visum::collision {
namespace {

constexpr double kAlignedCosine = 1.0 - 1e-9;  // the direction is the face's own normal, up to rounding
// A point that is outside a face's edge by this much still counts as over the face. Where two edges lie on
// each other, as in a pile of equal boxes, their crossing would otherwise be anywhere along them, and
// elsewhere in each tick.
constexpr double kEdgeSlackM = 1e-6;
constexpr double kSamePointSquaredM = 1e-14;

// A feature, moved from the shape's frame to W.
Feature placed(const Placed& side, Feature feature) {
  for (std::size_t i = 0; i < feature.polygon.count; ++i)
    feature.polygon.points[i] = side.p + side.R * feature.polygon.points[i];
  feature.normal = side.R * feature.normal;
  return feature;
}

// The part of a polygon (or segment, or point) on the inner side of a plane: Sutherland-Hodgman.
void clip(const Polygon& in, const Eigen::Vector3d& outward, const Eigen::Vector3d& on_plane, Polygon& out) {
  out.count = 0;
  const double limit = outward.dot(on_plane) + kEdgeSlackM;
  const std::size_t edges = in.count > 2 ? in.count : in.count - (in.count > 1 ? 1 : 0);
  if (in.count <= 2 && in.count > 0 && outward.dot(in.points[0]) <= limit) out.add(in.points[0]);
  for (std::size_t i = 0; in.count > 1 && i < edges; ++i) {
    const Eigen::Vector3d& from = in.points[i];
    const Eigen::Vector3d& to = in.points[(i + 1) % in.count];
    const double d_from = outward.dot(from) - limit, d_to = outward.dot(to) - limit;
    if ((d_from > 0.0) != (d_to > 0.0)) out.add(from + (to - from) * (d_from / (d_from - d_to)));
    if (d_to <= 0.0) out.add(to);
  }
}

// The part of the incident feature over the reference face.
Polygon clip_to_face(const Polygon& incident, const Feature& reference) {
  Polygon both[2] = {incident, {}};
  std::size_t now = 0;
  const Polygon& face = reference.polygon;
  for (std::size_t i = 0; i < face.count && both[now].count > 0; ++i) {
    const Eigen::Vector3d& from = face.points[i];
    const Eigen::Vector3d side = (face.points[(i + 1) % face.count] - from).cross(reference.normal);
    const double length = side.norm();
    if (length == 0.0) continue;
    clip(both[now], side / length, from, both[1 - now]);
    now = 1 - now;
  }
  return both[now];
}

// Adds the points of the incident feature below the reference face, whose outward normal is `normal`. Returns
// whether there are any.
bool add_face_contacts(const Feature& reference, const Feature& incident, const Eigen::Vector3d& normal_W,
                       std::vector<Point>& points) {
  const Eigen::Vector3d& toward = reference.normal;
  const Polygon clipped = clip_to_face(incident.polygon, reference);
  bool any = false;
  for (std::size_t i = 0; i < clipped.count; ++i) {
    const double height = toward.dot(clipped.points[i] - reference.polygon.points[0]) - incident.radius;
    if (height >= 0.0) continue;
    const Eigen::Vector3d surface = clipped.points[i] - incident.radius * toward;
    points.push_back({surface - 0.5 * height * toward, normal_W, -height});
    any = true;
  }
  return any;
}

// Adds the nearest points of two edges, or points, where they overlap along n.
bool add_edge_contacts(const Feature& a, const Feature& b, const Eigen::Vector3d& n,
                       std::vector<Point>& points) {
  const std::size_t before = points.size();
  for (const auto& [on_a, on_b] : nearest_points(a.polygon, b.polygon)) {
    const Eigen::Vector3d surface_a = on_a - a.radius * n, surface_b = on_b + b.radius * n;
    const double depth = n.dot(surface_b - surface_a);
    if (depth > 0.0) points.push_back({0.5 * (surface_a + surface_b), n, depth});
  }
  return points.size() > before;
}

bool is_aligned(const Feature& face, const Eigen::Vector3d& direction) {
  return face.flat && face.normal.dot(direction) > kAlignedCosine;
}

// Squared distance of a point from the nearest of those kept, m².
double distance_squared(const Point& point, const std::vector<Point>& points,
                        std::span<const std::size_t> kept) {
  double least = std::numeric_limits<double>::infinity();
  for (const std::size_t k : kept) least = std::min(least, (points[k].p_W - point.p_W).squaredNorm());
  return least;
}

// Keeps the deepest point and those that are spread farthest.
void keep_spread(std::vector<Point>& points, std::size_t first, std::size_t most) {
  std::array<std::size_t, kMaxPolygon> kept;
  std::size_t count = 1;
  kept[0] = first;
  for (std::size_t i = first; i < points.size(); ++i) {
    if (points[i].depth > points[kept[0]].depth) kept[0] = i;
  }
  for (; count < std::min(most, kept.size()); ++count) {
    kept[count] = first;
    double farthest = -1.0;
    for (std::size_t i = first; i < points.size(); ++i) {
      const double distance = distance_squared(points[i], points, std::span(kept.data(), count));
      if (distance <= farthest) continue;
      farthest = distance;
      kept[count] = i;
    }
  }
  std::sort(kept.begin(), kept.begin() + static_cast<std::ptrdiff_t>(count));
  for (std::size_t k = 0; k < count; ++k) points[first + k] = points[kept[k]];
  points.resize(first + count);
}

}  // namespace

bool add_face_manifold(const Placed& a, const Placed& b, const Eigen::Vector3d& normal_W,
                       std::vector<Point>& points) {
  const Feature face_a = placed(a, a.convex->feature(-(a.R.transpose() * normal_W)));
  const Feature face_b = placed(b, b.convex->feature(b.R.transpose() * normal_W));
  if (is_aligned(face_b, normal_W)) return add_face_contacts(face_b, face_a, normal_W, points);
  if (is_aligned(face_a, -normal_W)) return add_face_contacts(face_a, face_b, normal_W, points);
  return false;
}

void add_manifold(const Placed& a, const Placed& b, const Direction& direction, std::vector<Point>& points) {
  const Eigen::Vector3d& n = direction.normal_W;
  if (add_face_manifold(a, b, n, points)) return;
  const Feature edge_a = placed(a, a.convex->edge(-(a.R.transpose() * n)));
  const Feature edge_b = placed(b, b.convex->edge(b.R.transpose() * n));
  if (add_edge_contacts(edge_a, edge_b, n, points)) return;
  // The shapes overlap, but the features found lie beside each other: one point, midway between the deepest
  // ones.
  points.push_back({0.5 * (a.farthest(-n) + b.farthest(n)), n, direction.depth});
}

void reduce(std::vector<Point>& points, std::size_t first, std::size_t most) {
  const auto begin = points.begin() + static_cast<std::ptrdiff_t>(first);
  auto end = begin;
  // Points at the same place become one, the deepest; it is moved to the front part of the list.
  for (auto it = begin; it != points.end(); ++it) {
    const auto same = std::find_if(begin, end, [&](const Point& known) {
      return (known.p_W - it->p_W).squaredNorm() <= kSamePointSquaredM;
    });
    if (same == end)
      std::iter_swap(end++, it);
    else if (it->depth > same->depth)
      *same = *it;
  }
  points.erase(end, points.end());
  if (points.size() - first <= most) return;
  keep_spread(points, first, most);
}

}  // namespace visum::collision

// An incremental hull. It starts with a tetrahedron. Each point outside then replaces the faces that it sees
// by a fan from itself to their horizon. The work is quadratic, done once at load, for at most a few thousand
// points.
#include "server/collision/hull.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <numeric>
#include <stdexcept>

namespace visum::collision {
namespace {

using Points = std::span<const Eigen::Vector3d>;
constexpr double kFlatness = 1e-7;  // share of the hull's size: a point nearer to a face counts as on it
constexpr double kCoplanar = 1e-5;  // share of the hull's size: faces this close to one plane are one polygon

struct Triangle {
  std::array<std::uint32_t, 3> corners;
  Eigen::Vector3d normal;
  double offset;  // normal · x on the plane
};

Triangle make_triangle_of(Points points, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const Eigen::Vector3d normal = (points[b] - points[a]).cross(points[c] - points[a]).normalized();
  return {{a, b, c}, normal, normal.dot(points[a])};
}

template <typename Measure>
std::uint32_t argmax(Points points, Measure measure) {
  std::uint32_t best = 0;
  for (std::uint32_t i = 1; i < points.size(); ++i) {
    if (measure(points[i]) > measure(points[best])) best = i;
  }
  return best;
}

// Four points that are far apart, as four outward faces.
std::vector<Triangle> first_tetrahedron(Points points, double tolerance) {
  const std::uint32_t a = argmax(points, [](const Eigen::Vector3d& p) { return p.x(); });
  const std::uint32_t b =
      argmax(points, [&](const Eigen::Vector3d& p) { return (p - points[a]).squaredNorm(); });
  const Eigen::Vector3d line = (points[b] - points[a]).normalized();
  const std::uint32_t c =
      argmax(points, [&](const Eigen::Vector3d& p) { return (p - points[a]).cross(line).squaredNorm(); });
  const Triangle base = make_triangle_of(points, a, b, c);
  const std::uint32_t d =
      argmax(points, [&](const Eigen::Vector3d& p) { return std::abs(base.normal.dot(p) - base.offset); });
  const double height = base.normal.dot(points[d]) - base.offset;
  if (!(std::abs(height) > tolerance)) throw std::runtime_error("the points of a convex hull span no volume");
  const auto [p, q] = height > 0 ? std::pair(c, b) : std::pair(b, c);  // the base looks away from d
  return {make_triangle_of(points, a, p, q), make_triangle_of(points, a, d, p),
          make_triangle_of(points, p, d, q), make_triangle_of(points, q, d, a)};
}

// Adds a point, if it lies outside.
void add_point(std::vector<Triangle>& hull, Points points, std::uint32_t point, double tolerance) {
  const auto sees = [&](const Triangle& face) {
    return face.normal.dot(points[point]) - face.offset > tolerance;
  };
  // An edge of the seen faces is on the horizon if its reverse is not seen.
  std::map<std::pair<std::uint32_t, std::uint32_t>, bool> horizon;
  for (const Triangle& face : hull) {
    if (!sees(face)) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t from = face.corners[i], to = face.corners[(i + 1) % 3];
      if (horizon.erase({to, from}) == 0) horizon[{from, to}] = true;
    }
  }
  if (horizon.empty()) return;
  std::erase_if(hull, sees);
  for (const auto& [edge, unused] : horizon)
    hull.push_back(make_triangle_of(points, edge.first, edge.second, point));
}

// The corners of the polygon in a face's plane, counter-clockwise about the normal: the convex hull in the
// plane (Andrew's monotone chain), without points inside or on an edge.
std::vector<std::uint32_t> polygon_on(Points points, const std::vector<std::uint32_t>& on_hull,
                                      const Triangle& plane, double tolerance) {
  std::vector<std::uint32_t> near;
  for (const std::uint32_t i : on_hull) {
    if (std::abs(plane.normal.dot(points[i]) - plane.offset) <= tolerance) near.push_back(i);
  }
  const Eigen::Vector3d u = plane.normal.unitOrthogonal(), v = plane.normal.cross(u);
  const auto place = [&](std::uint32_t i) { return std::pair(u.dot(points[i]), v.dot(points[i])); };
  std::sort(near.begin(), near.end(), [&](auto i, auto j) { return place(i) < place(j); });
  const auto turns_left = [&](std::uint32_t i, std::uint32_t j, std::uint32_t k) {
    const Eigen::Vector3d first = points[j] - points[i], second = points[k] - points[j];
    return plane.normal.dot(first.cross(second)) > tolerance * (first + second).norm();
  };
  const auto chain = [&](auto begin, auto end) {
    std::vector<std::uint32_t> corners;
    for (auto it = begin; it != end; ++it) {
      while (corners.size() > 1 && !turns_left(corners[corners.size() - 2], corners.back(), *it))
        corners.pop_back();
      corners.push_back(*it);
    }
    corners.pop_back();  // the other chain begins with it
    return corners;
  };
  std::vector<std::uint32_t> corners = chain(near.begin(), near.end());
  const auto upper = chain(near.rbegin(), near.rend());
  corners.insert(corners.end(), upper.begin(), upper.end());
  return corners;
}

// Collects faces, and numbers the vertices that they use.
class PolytopeBuilder {
 public:
  explicit PolytopeBuilder(Points points) : points_(points), number_(points.size(), -1) {}

  void add_face(const Eigen::Vector3d& normal, const std::vector<std::uint32_t>& corners) {
    result_.faces.push_back({normal, static_cast<std::uint32_t>(result_.corners.size()),
                             static_cast<std::uint32_t>(corners.size())});
    for (const std::uint32_t i : corners) result_.corners.push_back(vertex(i));
  }
  Polytope finish() {
    index_polytope(result_);
    return std::move(result_);
  }

 private:
  std::uint32_t vertex(std::uint32_t point) {
    if (number_[point] < 0) {
      number_[point] = static_cast<std::int64_t>(result_.vertices.size());
      result_.vertices.push_back(points_[point]);
    }
    return static_cast<std::uint32_t>(number_[point]);
  }

  Points points_;
  std::vector<std::int64_t> number_;
  Polytope result_;
};

// Length of the diagonal of the box around the points.
double size_of(Points points) {
  Eigen::Vector3d low = points[0], high = points[0];
  for (const Eigen::Vector3d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).norm();
}

// Joins triangles in one plane to polygons.
Polytope join_coplanar(Points points, std::vector<Triangle> triangles, double tolerance) {
  std::vector<std::uint32_t> on_hull;
  for (const Triangle& t : triangles) on_hull.insert(on_hull.end(), t.corners.begin(), t.corners.end());
  std::sort(on_hull.begin(), on_hull.end());
  on_hull.erase(std::unique(on_hull.begin(), on_hull.end()), on_hull.end());
  const auto area = [&](const Triangle& t) {
    return (points[t.corners[1]] - points[t.corners[0]])
        .cross(points[t.corners[2]] - points[t.corners[0]])
        .norm();
  };
  // The largest triangles have the best normals, and stand for the small ones in their plane.
  std::stable_sort(triangles.begin(), triangles.end(), [&](auto& s, auto& t) { return area(s) > area(t); });
  PolytopeBuilder builder(points);
  std::vector<bool> joined(triangles.size(), false);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (joined[i]) continue;
    const auto corners = polygon_on(points, on_hull, triangles[i], tolerance);
    if (corners.size() > 2)
      builder.add_face(triangles[i].normal, corners);  // with fewer corners it is a sliver
    for (std::size_t j = i + 1; j < triangles.size(); ++j) {
      const auto is_on_plane = [&](std::uint32_t c) {
        return std::abs(triangles[i].normal.dot(points[c]) - triangles[i].offset) <= tolerance;
      };
      if (std::all_of(triangles[j].corners.begin(), triangles[j].corners.end(), is_on_plane))
        joined[j] = true;
    }
  }
  return builder.finish();
}

}  // namespace

Polytope make_hull(Points points) {
  const double size = size_of(points);
  std::vector<Triangle> hull = first_tetrahedron(points, kFlatness * size);
  for (std::uint32_t i = 0; i < points.size(); ++i) add_point(hull, points, i, kFlatness * size);
  return join_coplanar(points, std::move(hull), kCoplanar * size);
}

}  // namespace visum::collision

// An incremental hull. It starts with a tetrahedron. Each point outside then replaces the faces that it sees
// by a fan from itself to their horizon. The work is quadratic, done once at load, for at most a few thousand
// points. Most of it is to ask how high points lie above planes: Heights answers roughly for many at once,
// and what may count is asked again exactly. Where many points lie nearly in a plane, rounding may make a
// point see faces that are no neighbours, and the faces pile up. What comes out is checked, and then made
// anew from integers without rounding.
#include "server/collision/hull.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "server/collision/heights.h"

namespace visum::collision {
namespace {

using Points = std::span<const Eigen::Vector3d>;
constexpr double kFlatness = 1e-7;  // share of the hull's size: a point nearer to a face counts as on it
constexpr double kCoplanar = 1e-5;  // share of the hull's size: faces this close to one plane are one polygon

constexpr std::uint64_t kMostCells = 1024;  // by which points are moved: 4e-6 of the hull's size

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

// The border of the faces that a point sees: their edges of which the reverse is not among them.
class Horizon {
 public:
  void clear() { edges_.clear(); }
  bool empty() const { return edges_.empty(); }

  void add_face(const std::array<std::uint32_t, 3>& corners) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Edge edge(corners[i], corners[(i + 1) % 3]), reverse(edge.second, edge.first);
      const auto opposite = std::ranges::lower_bound(edges_, reverse);
      if (opposite != edges_.end() && *opposite == reverse) {
        edges_.erase(opposite);
        continue;
      }
      const auto place = std::ranges::lower_bound(edges_, edge);
      if (place == edges_.end() || *place != edge) edges_.insert(place, edge);
    }
  }

  // Calls visit(from, to) in ascending order.
  template <typename Visit>
  void visit(Visit visit_one) const {
    for (const auto& [from, to] : edges_) visit_one(from, to);
  }

 private:
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<Edge> edges_;  // sorted
};

double height_above(const Triangle& face, const Eigen::Vector3d& point) {
  return face.normal.dot(point) - face.offset;
}

// The faces that rounding leaves: not always a hull (see is_hull). Faces that are gone stay in the list for a
// while, so that the others need not move.
std::vector<Triangle> rounded_hull(Points points, double tolerance) {
  std::vector<Triangle> faces;
  std::vector<bool> is_gone;
  Heights planes(points);
  const auto add = [&](const Triangle& face) {
    faces.push_back(face);
    is_gone.push_back(false);
    planes.add_plane(face.normal, face.offset);
  };
  const auto remove_gone = [&] {
    std::size_t i = 0;
    std::erase_if(faces, [&](const Triangle&) { return is_gone[i++]; });
    is_gone.assign(faces.size(), false);
    planes.clear();
    for (const Triangle& face : faces) planes.add_plane(face.normal, face.offset);
  };
  for (const Triangle& face : first_tetrahedron(points, tolerance)) add(face);
  std::size_t count = faces.size();
  Horizon horizon;
  std::vector<std::size_t> seen;
  for (std::uint32_t i = 0; i < points.size() && count <= 2 * points.size(); ++i) {
    horizon.clear();
    seen.clear();
    planes.visit_planes_below(points[i], tolerance, [&](std::size_t f) {
      if (is_gone[f] || !(height_above(faces[f], points[i]) > tolerance)) return;
      horizon.add_face(faces[f].corners);
      seen.push_back(f);
    });
    if (horizon.empty()) continue;
    for (const std::size_t f : seen) {
      is_gone[f] = true;
      planes.drop(f);
    }
    count -= seen.size();
    horizon.visit([&](auto from, auto to) {
      add(make_triangle_of(points, from, to, i));
      ++count;
    });
    if (faces.size() > 2 * count) remove_gone();
  }
  remove_gone();
  return faces;
}

// True if the faces close, and no point lies beyond one. A closed surface of triangles has 2V - 4 of them.
bool is_hull(Points points, const std::vector<Triangle>& faces, double tolerance) {
  std::vector<bool> is_corner(points.size(), false);
  for (const Triangle& face : faces)
    for (const std::uint32_t corner : face.corners) is_corner[corner] = true;
  const auto corners = static_cast<std::size_t>(std::ranges::count(is_corner, true));
  if (faces.size() + 4 != 2 * corners) return false;
  Heights heights(points);
  for (const Eigen::Vector3d& point : points) heights.add_point(point);
  return std::ranges::all_of(faces, [&](const Triangle& face) {
    bool holds_all = true;
    heights.visit_points_above(face.normal, face.offset, tolerance, [&](std::size_t i) {
      holds_all = holds_all && height_above(face, points[i]) <= tolerance;
    });
    return holds_all;
  });
}

using Cell = Eigen::Matrix<std::int64_t, 3, 1>;
__extension__ typedef __int128 Volume;

struct CellFace {
  std::array<std::uint32_t, 3> corners;
  Cell normal;
};

// The points on a grid of 2^28 cells for the hull's size, each moved by less than so many cells, so that no
// four lie in one plane but by rare chance. Differences have at most 29 bits, normals 59, volumes 91.
std::vector<Cell> shaken(Points points, double size, std::uint64_t cells) {
  Eigen::Vector3d low = points[0];
  for (const Eigen::Vector3d& p : points) low = low.cwiseMin(p);
  std::uint64_t random = 1;
  std::vector<Cell> grid;
  for (const Eigen::Vector3d& p : points) {
    Cell& cell = grid.emplace_back();
    for (int axis = 0; axis < 3; ++axis) {
      random = random * 6364136223846793005u + 1442695040888963407u;  // Knuth's MMIX
      cell[axis] = std::llround((p[axis] - low[axis]) / size * (1 << 28)) +
                   static_cast<std::int64_t>((random >> 33) % cells);
    }
  }
  return grid;
}

// The hull of the shaken points: exact for them, and off by at most so many cells for the points.
std::vector<Triangle> exact_hull(Points points, double size, std::uint64_t cells) {
  const std::vector<Cell> grid = shaken(points, size, cells);
  const auto make = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return CellFace{{a, b, c}, (grid[b] - grid[a]).cross(grid[c] - grid[a])};
  };
  std::vector<CellFace> hull;
  for (const Triangle& face : first_tetrahedron(points, kFlatness * size))
    hull.push_back(make(face.corners[0], face.corners[1], face.corners[2]));
  Horizon horizon;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const auto is_seen = [&](const CellFace& face) {
      Volume volume = 0;
      const Cell from = grid[i] - grid[face.corners[0]];
      for (int axis = 0; axis < 3; ++axis) volume += static_cast<Volume>(face.normal[axis]) * from[axis];
      return volume > 0;
    };
    horizon.clear();
    for (const CellFace& face : hull)
      if (is_seen(face)) horizon.add_face(face.corners);
    if (horizon.empty()) continue;
    std::erase_if(hull, is_seen);
    horizon.visit([&](auto from, auto to) { hull.push_back(make(from, to, i)); });
  }
  std::vector<Triangle> faces;
  for (const CellFace& face : hull) {
    const Eigen::Vector3d normal = face.normal.cast<double>().normalized();
    double offset = -std::numeric_limits<double>::infinity();
    for (const std::uint32_t corner : face.corners) offset = std::max(offset, normal.dot(points[corner]));
    faces.push_back({face.corners, normal, offset});
  }
  return faces;
}

// The corners of the polygon of points in a face's plane, counter-clockwise about the normal: the convex hull
// in the plane (Andrew's monotone chain), without points inside or on an edge.
std::vector<std::uint32_t> polygon_of(Points points, std::vector<std::uint32_t> near, const Triangle& plane,
                                      double tolerance) {
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
  std::vector<std::pair<double, std::uint32_t>> by_area;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) by_area.emplace_back(area(triangles[i]), i);
  std::ranges::stable_sort(by_area, std::greater(), &std::pair<double, std::uint32_t>::first);
  std::vector<Triangle> sorted;
  for (const auto& [unused, i] : by_area) sorted.push_back(triangles[i]);
  triangles = std::move(sorted);
  PolytopeBuilder builder(points);
  std::vector<std::vector<std::uint32_t>> triangles_at(points.size());  // by corner
  for (const std::uint32_t v : on_hull) triangles_at[v].reserve(8);
  for (std::uint32_t i = 0; i < triangles.size(); ++i)
    for (const std::uint32_t corner : triangles[i].corners) triangles_at[corner].push_back(i);
  std::vector<bool> joined(triangles.size(), false), is_near(points.size(), false);
  std::vector<std::uint32_t> near;
  Heights heights(points);
  for (const std::uint32_t v : on_hull) heights.add_point(points[v]);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (joined[i]) continue;
    for (const std::uint32_t v : near) is_near[v] = false;
    near.clear();
    heights.visit_points_above(triangles[i].normal, triangles[i].offset, -tolerance, [&](std::size_t at) {
      const std::uint32_t v = on_hull[at];
      if (!(std::abs(height_above(triangles[i], points[v])) <= tolerance)) return;
      is_near[v] = true;
      near.push_back(v);
    });
    const auto corners = polygon_of(points, near, triangles[i], tolerance);
    if (corners.size() > 2)
      builder.add_face(triangles[i].normal, corners);  // with fewer corners it is a sliver
    for (const std::uint32_t v : near)
      for (const std::uint32_t j : triangles_at[v]) {
        const auto& [a, b, c] = triangles[j].corners;
        if (is_near[a] && is_near[b] && is_near[c]) joined[j] = true;
      }
  }
  return builder.finish();
}

}  // namespace

Polytope make_hull(Points points) {
  const double size = size_of(points);
  std::vector<Triangle> hull = rounded_hull(points, kFlatness * size);
  for (std::uint64_t cells = 64; !is_hull(points, hull, kCoplanar * size); cells *= 2) {
    if (cells > kMostCells) throw std::runtime_error("no convex hull of the points was found");
    hull = exact_hull(points, size, cells);
  }
  return join_coplanar(points, std::move(hull), kCoplanar * size);
}

}  // namespace visum::collision

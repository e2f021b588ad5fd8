#include "clients/visum/run/coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace visum::run {
namespace {

using Vector = std::array<double, 3>;

// A point seen from a pose (x y z qw qx qy qz): back by p, then turned by the conjugate of q.
Vector seen_from(const double* pose, const Vector& point) {
  const Vector d{point[0] - pose[0], point[1] - pose[1], point[2] - pose[2]};
  const double w = pose[3];
  const Vector u{-pose[4], -pose[5], -pose[6]};
  const auto cross = [](const Vector& a, const Vector& b) {
    return Vector{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  const Vector once = cross(u, d);
  const Vector twice = cross(u, {once[0] + w * d[0], once[1] + w * d[1], once[2] + w * d[2]});
  return {d[0] + 2 * twice[0], d[1] + 2 * twice[1], d[2] + 2 * twice[2]};
}

bool is_inside(const protocol::ShapeDescription& shape, const Vector& p) {
  const auto& size = shape.size;
  if (shape.kind == "box")
    return std::abs(p[0]) <= size[0] / 2 && std::abs(p[1]) <= size[1] / 2 && std::abs(p[2]) <= size[2] / 2;
  if (shape.kind == "sphere") return std::hypot(p[0], p[1], p[2]) <= size[0];
  if (shape.kind == "cylinder") return std::hypot(p[0], p[1]) <= size[0] && std::abs(p[2]) <= size[1] / 2;
  if (shape.kind == "capsule")
    return std::hypot(p[0], p[1], p[2] - std::clamp(p[2], -size[1] / 2, size[1] / 2)) <= size[0];
  return shape.kind == "plane" && p[2] < 0.0;
}

}  // namespace

bool is_plain(const protocol::ShapeDescription& shape) {
  return shape.kind != "mesh" && shape.kind != "convex";
}

Coverage::Coverage(const FloorSpec& spec, std::vector<Obstacle> obstacles)
    : spec_(spec), obstacles_(std::move(obstacles)) {}

void Coverage::go_on(Coverage&& earlier) {
  open_ = std::move(earlier.open_);
  free_ = earlier.free_;
  known_ = earlier.known_;
}

void Coverage::find_free_cells(const std::vector<double>& poses) {
  const auto stands_in_the_way = [&](double x, double y) {
    return std::any_of(obstacles_.begin(), obstacles_.end(), [&](const Obstacle& obstacle) {
      const Vector in_body = seen_from(&poses[7 * obstacle.body], {x, y, spec_.height_m});
      return is_inside(obstacle.shape, seen_from(obstacle.shape.pose.data(), in_body));
    });
  };
  const double half = spec_.cell_m / 2;
  for (double x = spec_.from[0] + half; x < spec_.to[0]; x += spec_.cell_m)
    for (double y = spec_.from[1] + half; y < spec_.to[1]; y += spec_.cell_m)
      if (!stands_in_the_way(x, y)) open_.push_back({x, y});
  free_ = open_.size();
  known_ = true;
}

void Coverage::note(double x, double y, const std::vector<double>& poses) {
  const bool complete = std::all_of(obstacles_.begin(), obstacles_.end(), [&](const Obstacle& obstacle) {
    return poses.size() >= 7 * (obstacle.body + 1);
  });
  if (!complete) return;
  if (!known_) find_free_cells(poses);
  std::erase_if(open_,
                [&](const auto& cell) { return std::hypot(cell[0] - x, cell[1] - y) <= spec_.within_m; });
}

double Coverage::share() const {
  if (!known_ || free_ == 0) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(free_ - open_.size()) / static_cast<double>(free_);
}

}  // namespace visum::run

#include "server/world/curve.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace visum::world {
namespace {

constexpr double kLeastChordM = 1e-9;
constexpr int kNewtonSteps = 30;
constexpr double kNearEnoughM = 1e-14;

bool usable(const std::vector<Eigen::Vector3d>& points, bool closed) {
  if (points.size() < (closed ? 3u : 2u)) return false;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i + 1 == points.size() && !closed) continue;
    if (!((points[(i + 1) % points.size()] - points[i]).norm() > kLeastChordM)) return false;
  }
  return true;
}

// The second derivatives m of a cubic spline: between neighbours a, b, c at distances g and h
//     g m_a + 2 (g + h) m_b + h m_c = 6 ((c - b)/h - (b - a)/g)
// with m = 0 at natural ends, or the first and last the same where it is closed.
std::vector<Eigen::Vector3d> spline_bends(const std::vector<Eigen::Vector3d>& p, const std::vector<double>& t,
                                          bool closed) {
  const auto n = static_cast<Eigen::Index>(p.size());
  Eigen::MatrixXd left = Eigen::MatrixXd::Identity(n, n);
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(n, 3);
  const auto set_row = [&](Eigen::Index row, Eigen::Index before, Eigen::Index after, double g, double h) {
    const auto at = [&](Eigen::Index i) { return p[static_cast<std::size_t>(i)]; };
    left(row, row) = 2.0 * (g + h);
    left(row, before) += g;
    left(row, after) += h;
    right.row(row) = 6.0 * ((at(after) - at(row)) / h - (at(row) - at(before)) / g);
  };
  const auto gap = [&](Eigen::Index i) {
    return t[static_cast<std::size_t>(i) + 1] - t[static_cast<std::size_t>(i)];
  };
  for (Eigen::Index i = 1; i + 1 < n; ++i) set_row(i, i - 1, i + 1, gap(i - 1), gap(i));
  if (closed) {
    set_row(0, n - 2, 1, gap(n - 2), gap(0));
    left(n - 1, 0) = -1.0;
  }
  const Eigen::MatrixXd bends = left.partialPivLu().solve(right);
  std::vector<Eigen::Vector3d> result;
  for (Eigen::Index i = 0; i < n; ++i) result.push_back(bends.row(i));
  return result;
}

}  // namespace

Curve::Curve(const std::vector<Eigen::Vector3d>& points, bool closed) {
  if (!usable(points, closed)) return;
  closed_ = closed;
  points_ = points;
  if (closed) points_.push_back(points.front());
  knots_.push_back(0.0);
  for (std::size_t i = 1; i < points_.size(); ++i)
    knots_.push_back(knots_.back() + (points_[i] - points_[i - 1]).norm());
  bends_ = spline_bends(points_, knots_, closed);
}

Curve::Place Curve::at(double u) const {
  const double end = length();
  double within = closed_ ? u - end * std::floor(u / end) : std::clamp(u, 0.0, end);
  const auto above = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, within);
  const auto i = static_cast<std::size_t>(above - knots_.begin()) - 1;
  const double h = knots_[i + 1] - knots_[i];
  const double b = (within - knots_[i]) / h, a = 1.0 - b;
  const Eigen::Vector3d chord = (points_[i + 1] - points_[i]) / h;
  Place place;
  place.p = a * points_[i] + b * points_[i + 1] +
            ((a * a * a - a) * bends_[i] + (b * b * b - b) * bends_[i + 1]) * (h * h / 6.0);
  place.tangent = chord + ((3.0 * b * b - 1.0) * bends_[i + 1] - (3.0 * a * a - 1.0) * bends_[i]) * (h / 6.0);
  place.bend = a * bends_[i] + b * bends_[i + 1];
  if (!closed_ && within != u) {
    place.p += (u - within) * place.tangent;
    place.bend.setZero();
  }
  return place;
}

// (p - c(u))·c'(u) = 0 by Newton, with the curvature left out where it would lead away from the nearest
// place.
double Curve::nearest(const Eigen::Vector3d& p, double u) const {
  for (int i = 0; i < kNewtonSteps; ++i) {
    const Place place = at(u);
    const Eigen::Vector3d off = p - place.p;
    const double speed = place.tangent.squaredNorm();
    const double slope = speed - off.dot(place.bend);
    const double step = off.dot(place.tangent) / (slope > 0.1 * speed ? slope : speed);
    u += step;
    if (std::abs(step) < kNearEnoughM) break;
  }
  return u;
}

double Curve::nearest(const Eigen::Vector3d& p) const {
  constexpr int kPerChord = 8;
  const auto distance = [&](double u) { return (at(u).p - p).squaredNorm(); };
  double best = 0.0;
  for (std::size_t i = 0; i + 1 < knots_.size(); ++i) {
    for (int k = 0; k <= kPerChord; ++k) {
      const double u = knots_[i] + (knots_[i + 1] - knots_[i]) * k / kPerChord;
      if (distance(u) < distance(best)) best = u;
    }
  }
  return nearest(p, best);
}

}  // namespace visum::world

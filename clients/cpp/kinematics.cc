#include "clients/cpp/kinematics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "clients/cpp/visum.h"

namespace visum {
namespace {

using Vector = std::array<double, 3>;
using Quaternion = std::array<double, 4>;
using Column = std::array<double, 6>;  // how the tool moves (m) and turns (as a length) with one joint

constexpr double kMetresPerRadian = 0.3;  // so much is a radian worth
constexpr double kFirstDamping = 1e-3, kLeastDamping = 1e-9, kMostDamping = 1e6;
constexpr double kTurn = 3.14159265358979323846;  // a joint without limits starts within half a turn
constexpr std::array<double, 12> kPrimes{2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37};

Vector add(const Vector& a, const Vector& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
Vector scale(const Vector& a, double by) {
  return {by * a[0], by * a[1], by * a[2]};
}
Vector subtract(const Vector& a, const Vector& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Vector& a) {
  return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

Quaternion multiply(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}
Quaternion conjugate(const Quaternion& q) {
  return {q[0], -q[1], -q[2], -q[3]};
}
Vector rotate(const Quaternion& q, const Vector& v) {
  const Vector u{q[1], q[2], q[3]};
  const Vector t = scale(cross(u, v), 2.0);
  return add(add(v, scale(t, q[0])), cross(u, t));
}

// The rotation from `from` to `to` as a vector: its direction is the axis, its length the angle, at most pi.
Vector rotation_between(const Quaternion& from, const Quaternion& to) {
  const Quaternion q = multiply(to, conjugate(from));
  const Vector axis{q[1], q[2], q[3]};
  const double sine = length(axis);
  if (sine < 1e-12) return {};
  const double angle = 2.0 * std::atan2(sine, std::abs(q[0]));
  return scale(axis, (q[0] < 0.0 ? -angle : angle) / sine);
}

Pose motion(const ChainJoint& joint, double value) {
  if (joint.slides) return {scale(joint.axis, value), {1.0, 0.0, 0.0, 0.0}};
  const Vector axis = scale(joint.axis, std::sin(value / 2.0));
  return {{}, {std::cos(value / 2.0), axis[0], axis[1], axis[2]}};
}

Column weighted(const Vector& linear, const Vector& angular) {
  const Vector turn = scale(angular, kMetresPerRadian);
  return {linear[0], linear[1], linear[2], turn[0], turn[1], turn[2]};
}

double dot(const Column& a, const Column& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

std::vector<Column> jacobian(const std::vector<ChainJoint>& joints, std::span<const double> values) {
  std::vector<std::pair<Vector, Vector>> axes;  // each joint's place and axis
  Pose pose;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const Pose frame = compose(pose, joints[i].frame);
    axes.emplace_back(frame.position, rotate(frame.orientation, joints[i].axis));
    pose = compose(compose(frame, motion(joints[i], values[i])), joints[i].child);
  }
  std::vector<Column> columns;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const auto& [at, axis] = axes[i];
    columns.push_back(joints[i].slides ? weighted(axis, {})
                                       : weighted(cross(axis, subtract(pose.position, at)), axis));
  }
  return columns;
}

// Solves for a symmetric positive definite matrix by Cholesky's method.
std::vector<double> solve_positive(std::vector<std::vector<double>> matrix, std::vector<double> right) {
  const std::size_t n = right.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = matrix[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= matrix[i][k] * matrix[j][k];
      matrix[i][j] =
          i == j ? std::sqrt(std::max(sum, std::numeric_limits<double>::min())) : sum / matrix[j][j];
    }
    for (std::size_t k = 0; k < i; ++k) right[i] -= matrix[i][k] * right[k];
    right[i] /= matrix[i][i];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t k = i + 1; k < n; ++k) right[i] -= matrix[k][i] * right[k];
    right[i] /= matrix[i][i];
  }
  return right;
}

double cost(const InverseSolution& solution) {
  const double turn = kMetresPerRadian * solution.rotation_error;
  return solution.position_error * solution.position_error + turn * turn;
}

void check_length(std::span<const double> values, std::size_t wanted) {
  if (values.size() == wanted) return;
  throw Error(ErrorCode::kMisuse,
              std::to_string(values.size()) + " values were given for " + std::to_string(wanted) + " joints");
}

}  // namespace

Pose compose(const Pose& outer, const Pose& inner) {
  return {add(outer.position, rotate(outer.orientation, inner.position)),
          multiply(outer.orientation, inner.orientation)};
}

Pose inverse_of(const Pose& pose) {
  const Quaternion back = conjugate(pose.orientation);
  return {scale(rotate(back, pose.position), -1.0), back};
}

Chain::Chain(std::string base, std::vector<ChainJoint> joints)
    : base_(std::move(base)), joints_(std::move(joints)) {}

Pose Chain::forward(std::span<const double> values) const {
  check_length(values, size());
  Pose pose;
  for (std::size_t i = 0; i < size(); ++i)
    pose = compose(compose(compose(pose, joints_[i].frame), motion(joints_[i], values[i])), joints_[i].child);
  return pose;
}

InverseSolution Chain::inverse(const Pose& tool, std::span<const double> start,
                               const InverseOptions& options) const {
  check_length(start, size());
  InverseSolution best = descend(tool, clamped(start), options);
  for (int n = 1; n < options.starts && !best.reached; ++n) {
    InverseSolution found = descend(tool, spread(n), options);
    if (found.reached || cost(found) < cost(best)) best = std::move(found);
  }
  return best;
}

InverseSolution Chain::descend(const Pose& tool, std::vector<double> values,
                               const InverseOptions& options) const {
  InverseSolution now = judge(tool, std::move(values), options.tolerance);
  double damping = kFirstDamping;
  for (int i = 0; i < options.iterations && !now.reached; ++i) {
    auto next = step(tool, now.values, damping);
    for (std::size_t j = 0; j < size(); ++j) next[j] += now.values[j];
    InverseSolution then = judge(tool, clamped(next), options.tolerance);
    if (cost(then) < cost(now)) {
      now = std::move(then);
      damping = std::max(kLeastDamping, damping / 5.0);
    } else {
      damping *= 4.0;
      if (damping > kMostDamping) break;
    }
  }
  return now;
}

InverseSolution Chain::judge(const Pose& tool, std::vector<double> values, double tolerance) const {
  const Pose is = forward(values);
  InverseSolution solution{std::move(values), false, length(subtract(tool.position, is.position)),
                           length(rotation_between(is.orientation, tool.orientation))};
  solution.reached = solution.position_error <= tolerance && solution.rotation_error <= tolerance;
  return solution;
}

// Solves (JᵀJ + damping) step = Jᵀ error. A joint at a limit that the step would leave does not take part.
std::vector<double> Chain::step(const Pose& tool, std::span<const double> values, double damping) const {
  const Pose is = forward(values);
  const Column error =
      weighted(subtract(tool.position, is.position), rotation_between(is.orientation, tool.orientation));
  const auto columns = jacobian(joints_, values);
  std::vector<bool> free(size(), true);
  while (true) {
    std::vector<std::vector<double>> normal(size(), std::vector<double>(size(), 0.0));
    std::vector<double> right(size(), 0.0);
    for (std::size_t i = 0; i < size(); ++i) {
      normal[i][i] = damping;
      if (!free[i]) continue;
      right[i] = dot(columns[i], error);
      for (std::size_t j = 0; j < size(); ++j)
        if (free[j]) normal[i][j] += dot(columns[i], columns[j]);
    }
    auto found = solve_positive(std::move(normal), std::move(right));
    bool stuck = false;  // ends, because each round takes a joint out
    for (std::size_t i = 0; i < size() && !stuck; ++i) {
      stuck = free[i] && ((values[i] <= joints_[i].lower && found[i] < 0.0) ||
                          (values[i] >= joints_[i].upper && found[i] > 0.0));
      if (stuck) free[i] = false;
    }
    if (!stuck) return found;
  }
}

std::vector<double> Chain::clamped(std::span<const double> values) const {
  std::vector<double> within(values.begin(), values.end());
  for (std::size_t i = 0; i < size(); ++i)
    within[i] = std::min(joints_[i].upper, std::max(joints_[i].lower, within[i]));
  return within;
}

// Spread evenly over the joints' ranges, each joint by its own irrational step.
std::vector<double> Chain::spread(int number) const {
  std::vector<double> values;
  for (std::size_t i = 0; i < size(); ++i) {
    const double from = std::isfinite(joints_[i].lower) ? joints_[i].lower : -kTurn;
    const double to = std::isfinite(joints_[i].upper) ? joints_[i].upper : kTurn;
    values.push_back(from + std::fmod(number * std::sqrt(kPrimes[i % kPrimes.size()]), 1.0) * (to - from));
  }
  return values;
}

}  // namespace visum

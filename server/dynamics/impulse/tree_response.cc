// Finds what impulses on a tree do to each other, without an answer of the whole tree for each of them.
//
// With L the way of impulses to the root (load_tree), the tree's response is  L^T D^-1 L + R^T I^-1 R: an
// impulse i gives e_i to the axis of each row on its way, and R_i to a free root. Only what lies on both ways
// counts:
//   W_ij = sum over rows of e_i D^-1 e_j  +  sum over roots of R_i^T I^-1 R_j
// Source: the innovations factorisation of the inverse mass matrix, Rodriguez, Jain, Kreutz-Delgado, Spatial
// operator factorization and inversion of the manipulator mass matrix, IEEE Trans. Robotics and Automation 8
// (1992).
#include <algorithm>

#include "server/dynamics/impulse/tree.h"

namespace visum::dynamics::impulse {

TreePush Tree::push_at(int node, const Vector3d& angular, const Vector3d& linear) const {
  TreePush push;
  if (node < 0) return push;
  push.row = static_cast<int>(row_of_[static_cast<std::size_t>(node)]);
  Eigen::Map<Eigen::Vector4d>(push.angular) << angular, 0.0;
  Eigen::Map<Eigen::Vector4d>(push.linear) << linear, 0.0;
  return push;
}

TreePush Tree::push_on_axis(std::size_t node) const {
  TreePush push;
  push.row = static_cast<int>(row_of_[node]);
  std::ranges::fill(push.angular, 0.0);
  std::ranges::fill(push.linear, 0.0);
  push.axis = 1.0;
  return push;
}

void Tree::begin_traces(std::size_t count) {
  ways_.clear();
  way_rows_.clear();
  step_count_ = 0;
  width_ = count + kMostTogether - 1;  // the kernels work on four columns at a time
  matrix_.assign(places() * width_, 0.0);
  answers_of_way_.resize(places());
}

void Tree::trace(std::span<const TreePush> a, std::span<const TreePush> b) {
  const std::size_t first = way_rows_.size(), column = ways_.size();
  const std::size_t count = kernels_->trace_tree(data(), rows_.size(), a.data(), b.data(), a.size(),
                                                 &matrix_[column], width_, way_.data());
  way_rows_.insert(way_rows_.end(), way_.begin(), way_.begin() + static_cast<std::ptrdiff_t>(count));
  ways_.resize(column + a.size(), {first, count});
  step_count_ += a.size() * count;
}

// The sum of the matrix' rows, with the answers of the axes on the way, and of the root, as factors.
void Tree::find_responses_of(std::size_t i, double* to) {
  WayTerm* answer = answers_of_way_.data();
  for (std::size_t root = 0; root < roots_.size(); ++root) {
    const std::size_t place = rows_.size() + 6 * root;
    Vector6 load;
    for (std::size_t k = 0; k < 6; ++k) load[static_cast<int>(k)] = matrix_[(place + k) * width_ + i];
    const Vector6 rates = roots_[root].inverse * load;
    for (std::size_t k = 0; k < 6; ++k) *answer++ = {place + k, rates[static_cast<int>(k)]};
  }
  for (const std::size_t row : std::span(way_rows_).subspan(ways_[i].first, ways_[i].count))
    *answer++ = {row, factors_[row].inverse_D * matrix_[row * width_ + i]};
  const auto count = static_cast<std::size_t>(answer - answers_of_way_.data());
  kernels_->sum_ways(matrix_.data(), width_, answers_of_way_.data(), count, i + 1, to);
}

void Tree::find_response(double* W) {
  const std::size_t n = ways_.size();
  for (std::size_t i = 0; i < n; ++i) {
    find_responses_of(i, W + i * n);
    for (std::size_t j = 0; j < i; ++j) W[j * n + i] = W[i * n + j];
  }
}

void Tree::find_responses_to(std::span<const WayPoint> way, int lane, double* to) {
  for (std::size_t k = 0; k < way.size(); ++k) answers_of_way_[k] = {way[k].place, way[k].answer[lane]};
  kernels_->sum_ways(matrix_.data(), width_, answers_of_way_.data(), way.size(), ways_.size(), to);
}

void Tree::trace(std::span<const TreePush> a, std::span<const TreePush> b, std::vector<WayPoint>& way) {
  using FourAlong = Eigen::Map<const Eigen::Vector4d>;
  std::fill(on_way_.begin() + static_cast<std::ptrdiff_t>(rows_.size() * kMostTogether), on_way_.end(), 0.0);
  const std::size_t count = kernels_->trace_tree(data(), rows_.size(), a.data(), b.data(), a.size(),
                                                 on_way_.data(), kMostTogether, way_.data());
  // The roots that are reached.
  for (std::size_t root = roots_.size(); root-- > 0;) {
    const std::size_t place = rows_.size() + 6 * root;
    const Eigen::Map<const Eigen::Matrix<double, 4, 6>> load(&on_way_[place * kMostTogether]);
    if (load.isZero(0.0)) continue;
    const Eigen::Matrix<double, 4, 6> rates = load * roots_[root].inverse;
    for (int k = 6; k-- > 0;) way.push_back({place + static_cast<std::size_t>(k), load.col(k), rates.col(k)});
  }
  for (const std::size_t row : std::span(way_).first(count)) {
    const FourAlong e(&on_way_[row * kMostTogether]);
    way.push_back({row, e, factors_[row].inverse_D * e});
  }
}

// Both ways are sorted, the last place first. Only places that both lead through count.
Eigen::Matrix4d Tree::response(std::span<const WayPoint> a, std::span<const WayPoint> b) {
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    if (a[i].place == b[j].place)
      sum.noalias() += a[i++].given * b[j++].answer.transpose();
    else
      ++(a[i].place > b[j].place ? i : j);
  }
  return sum;
}

}  // namespace visum::dynamics::impulse

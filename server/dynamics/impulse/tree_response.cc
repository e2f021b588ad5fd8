// Finds what impulses on a tree do to each other, without an answer of the whole tree for each of them.
//
// With L the way of impulses to the root (load_tree), the tree's response is  L^T D^-1 L + R^T I^-1 R: an
// impulse i gives e_i to the axis of each row on its way, and R_i to the free root. Only the rows that lie on
// both ways count:
//   W_ij = sum over rows of e_i D^-1 e_j  +  R_i^T I^-1 R_j
// Source: the innovations factorisation of the inverse mass matrix, Rodriguez, Jain, Kreutz-Delgado, Spatial
// operator factorization and inversion of the manipulator mass matrix, IEEE Trans. Robotics and Automation 8
// (1992).
#include <algorithm>
#include <cassert>

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
  matrix_.assign((rows_.size() + 6) * width_, 0.0);
  way_.resize(rows_.size());
  answers_of_way_.resize(rows_.size() + 6);
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
  if (!roots_.empty()) {
    Vector6 load;
    for (std::size_t k = 0; k < 6; ++k) load[static_cast<int>(k)] = matrix_[(rows_.size() + k) * width_ + i];
    const Vector6 rates = roots_[0].inverse * load;
    for (std::size_t k = 0; k < 6; ++k) *answer++ = {rows_.size() + k, rates[static_cast<int>(k)]};
  }
  for (const std::size_t row : std::span(way_rows_).subspan(ways_[i].first, ways_[i].count))
    *answer++ = {row, factors_[row].inverse_D * matrix_[row * width_ + i]};
  const auto count = static_cast<std::size_t>(answer - answers_of_way_.data());
  kernels_->sum_ways(matrix_.data(), width_, answers_of_way_.data(), count, i + 1, to);
}

void Tree::find_response(double* W) {
  assert(roots_.size() <= 1);
  const std::size_t n = ways_.size();
  for (std::size_t i = 0; i < n; ++i) {
    find_responses_of(i, W + i * n);
    for (std::size_t j = 0; j < i; ++j) W[j * n + i] = W[i * n + j];
  }
}

}  // namespace visum::dynamics::impulse

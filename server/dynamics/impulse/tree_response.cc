// Finds what impulses on a tree do to each other, without an answer of the whole tree for each of them.
//
// With L the way of impulses to the root (load_tree), the tree's response is  L^T D^-1 L + R^T I^-1 R: an
// impulse i gives e_i to the axis of each row on its way, and R_i to the free root. Only the rows that lie on
// both ways count:
//   W_ij = sum over rows of e_i D^-1 e_j  +  R_i^T I^-1 R_j
// Source: the innovations factorisation of the inverse mass matrix, Rodriguez, Jain, Kreutz-Delgado, Spatial
// operator factorization and inversion of the manipulator mass matrix, IEEE Trans. Robotics and Automation 8
// (1992).
#include <cassert>

#include "server/dynamics/impulse/tree.h"

namespace visum::dynamics::impulse {

TreePush Tree::push_at(int node, const Vector3d& angular, const Vector3d& linear) const {
  TreePush push;
  if (node < 0) return push;
  push.row = static_cast<int>(row_of_[static_cast<std::size_t>(node)]);
  Eigen::Map<Vector3d>(push.angular) = angular;
  Eigen::Map<Vector3d>(push.linear) = linear;
  return push;
}

TreePush Tree::push_on_axis(std::size_t node) const {
  TreePush push;
  push.row = static_cast<int>(row_of_[node]);
  push.axis = 1.0;
  return push;
}

void Tree::trace(const TreePush& a, const TreePush& b) {
  Trace& trace = traces_.emplace_back();
  trace.first = steps_.size();
  steps_.resize(trace.first + rows_.size());
  trace.root.setZero();
  trace.count = kernels_->trace_tree(data(), &a, &b, &steps_[trace.first], trace.root.data());
  steps_.resize(trace.first + trace.count);
}

void Tree::find_response(double* W) {
  assert(roots_.size() <= 1);
  const std::size_t n = traces_.size();
  shares_.assign(rows_.size(), 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    // The answers of the axes and of the root to impulse i; then what the others measure of them.
    const std::span<const TreeStep> way = steps_of(traces_[i]);
    for (const TreeStep& step : way) shares_[step.row] = factors_[step.row].inverse_D * step.e;
    Vector6 root = Vector6::Zero();
    if (!roots_.empty()) root.noalias() = roots_[0].inverse * traces_[i].root;
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = root.dot(traces_[j].root);
      for (const TreeStep& step : steps_of(traces_[j])) sum += step.e * shares_[step.row];
      W[i * n + j] = W[j * n + i] = sum;
    }
    for (const TreeStep& step : way) shares_[step.row] = 0.0;
  }
}

}  // namespace visum::dynamics::impulse

#include <cstring>
#include <type_traits>

#include "server/dynamics/impulse/tree.h"

namespace visum::dynamics::impulse {

// All bits zero are all numbers zero.
void Tree::clear() {
  static_assert(std::is_trivially_copyable_v<TreeAsked>);
  std::memset(static_cast<void*>(asked_.data()), 0, asked_.size() * sizeof(TreeAsked));
}

TreeData Tree::data() {
  return {rows_.data(), factors_.data(), asked_.data(), answers_.data(), loads_.data()};
}

void Tree::solve() {
  kernels_->load_tree(data(), 0, rows_.size());
  for (const Root& root : roots_) spread_root(root);
  kernels_->spread_tree(data(), 0, rows_.size());
}

// A free root: velocity = -I^-1 p, with p all load on it.
void Tree::spread_root(const Root& root) {
  Eigen::Matrix<double, 6, 1> load;
  load << VectorView(loads_[root.row].w), VectorView(loads_[root.row].v);
  const Eigen::Matrix<double, 6, 1> velocity = -root.inverse * load;
  Eigen::Map<Vector3d>(answers_[root.row].w) = velocity.head<3>();
  Eigen::Map<Vector3d>(answers_[root.row].v) = velocity.tail<3>();
}

// D q' + S^T p + U^T (w1, v1) = lambda, solved for the drive's part of lambda.
double Tree::axis_impulse(std::size_t i) const {
  const std::size_t row = row_of_[i];
  const TreeFactor& f = factors_[row];
  if (!f.implicit) return 0.0;
  return f.D * answers_[row].rate + answers_[row].axis_load - asked_[row].axis_impulse;
}

double Tree::largest_answer() const {
  return kernels_->largest_answer_of_tree(answers_.data(), rows_.size());
}

void Tree::apply(Bodies& bodies) const {
  kernels_->apply_tree(rows_.data(), answers_.data(), rows_.size(), bodies.v.data()->data(),
                       bodies.w.data()->data());
}

void Tree::apply_and_note(Bodies& bodies, std::span<JointImpulse> given) {
  static_assert(sizeof(JointImpulse) == 6 * sizeof(double));
  kernels_->apply_and_note_tree(data(), bodies.inertia.data()->data(), rows_.size(), bodies.v.data()->data(),
                                bodies.w.data()->data(), given.data()->w.data());
}

}  // namespace visum::dynamics::impulse

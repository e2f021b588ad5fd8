// How a mechanism foresees what its joints give (prediction.h), and learns what they gave. Symbols: tree.h.
//
// The foreseen impulse of a joint has no share along the directions in which the joint is free, but for what
// drives give there: whatever is wrong with it does no work on the joints' motion, and the joints' gaps show
// all of it. Both bodies get it at the same point: momentum is kept to rounding.
#include <algorithm>

#include "server/dynamics/impulse/lanes/kernels.h"
#include "server/dynamics/impulse/mechanism.h"

namespace visum::dynamics::impulse {

void Mechanism::start_predicting() {
  if (loops_.empty()) prediction_ = Prediction(size());
}

bool Mechanism::predict(const Bodies& bodies) {
  if (!prediction_.is_ready()) return false;
  for (const std::size_t root : free_roots_) prediction_.foreseen()[root] = {};
  bodies.kernels().free_hinges_impulses(hinges_.data(), hinges_.size(), poses_[0].pa.data(),
                                        prediction_.foreseen()[0].w.data(), foreseen_axis_.data());
  for (const std::size_t i : other_nodes_) {
    const Motion& free = motions_[i];
    for (std::size_t k = 0; k < static_cast<std::size_t>(free.count); ++k) {
      const JointImpulse& f = prediction_.at(i);
      const double share = free.w[k].dot(f.w) + free.v[k].dot(f.v);
      foreseen_axis_[i] = share;
      add_along(i, k, -share);
    }
  }
  return true;
}

// On the coordinate of free direction k.
void Mechanism::add_along(std::size_t i, std::size_t k, double impulse) {
  const Vector3d &w = motions_[i].w[k], &v = motions_[i].v[k];
  const double share = impulse / (w.squaredNorm() + v.squaredNorm());
  JointImpulse& foreseen = prediction_.foreseen()[i];
  foreseen.w += share * w;
  foreseen.v += share * v;
}

void Mechanism::give_predicted(Bodies& bodies) {
  prediction_.give_foreseen();
  bodies.kernels().push_joints(bodies.arrays(), ends_.data(), ends_.size(), poses_[0].pa.data(),
                               prediction_.foreseen()[0].w.data());
}

void Mechanism::apply_ahead(Bodies& bodies) {
  predicts() ? tree_.apply_and_note(bodies, prediction_.ahead()) : apply(bodies);
}

void Mechanism::apply_after(Bodies& bodies) {
  predicts() ? tree_.apply_and_note(bodies, prediction_.after()) : apply(bodies);
}

double Mechanism::largest_turn(const Bodies& bodies) const {
  return bodies.kernels().largest_turn(bodies.arrays(), blocks_.data(), blocks_.size());
}

void Mechanism::nudge(Bodies& bodies, double h) const {
  bodies.kernels().nudge(bodies.arrays(), blocks_.data(), blocks_.size(), h, tree_.answers()->dv,
                         tree_.answers()->w);
}

}  // namespace visum::dynamics::impulse

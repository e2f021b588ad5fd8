// How a mechanism foresees what its joints give (prediction.h), and learns what they gave. Symbols: tree.h.
//
// The foreseen impulse of a joint has no share along the directions in which the joint is free, but for what
// drives give there: whatever is wrong with it does no work on the joints' motion, and the joints' gaps show
// all of it. Both bodies get it at the same point: momentum is kept to rounding.
#include <algorithm>

#include "server/dynamics/impulse/mechanism.h"

namespace visum::dynamics::impulse {

void Mechanism::start_predicting() {
  if (loops_.empty()) prediction_ = Prediction(size());
}

bool Mechanism::predict() {
  if (!prediction_.is_ready()) return false;
  for (std::size_t i = 0; i < size(); ++i) {
    if (carrying(i) == nullptr) continue;
    JointImpulse& f = foreseen_[i] = prediction_.at(i);
    const Motion& free = motions_[i];
    for (std::size_t k = 0; k < static_cast<std::size_t>(free.count); ++k) {
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
  foreseen_[i].w += share * w;
  foreseen_[i].v += share * v;
}

void Mechanism::take_back(Bodies& bodies) const {
  for (std::size_t i = 0; i < size(); ++i) {
    bodies.v[static_cast<std::size_t>(body(i))] = unpushed_v_[i];
    bodies.w[static_cast<std::size_t>(body(i))] = unpushed_w_[i];
  }
}

void Mechanism::give_predicted(Bodies& bodies) {
  for (std::size_t i = 0; i < size(); ++i) {
    unpushed_v_[i] = bodies.v[static_cast<std::size_t>(body(i))];
    unpushed_w_[i] = bodies.w[static_cast<std::size_t>(body(i))];
  }
  for (std::size_t i = 0; i < size(); ++i) {
    if (carrying(i) == nullptr) continue;
    const JointImpulse& f = foreseen_[i];
    prediction_.add_ahead(i, f);
    const Vector3d& p = poses_[i].pb;
    const auto give = [&](int number, double sign) {
      if (number < 0) return;
      const auto b = static_cast<std::size_t>(number);
      bodies.v[b] += (sign * bodies.constants[b].inverse_mass) * f.v;
      bodies.w[b] += sign * (bodies.inverse_inertia[b] * (f.w + (p - bodies.x[b]).cross(f.v)));
    };
    give(specs_[i].b, 1.0);
    give(specs_[i].a, -1.0);
  }
}

// From the tips to the root: what a joint gives is what all beyond it got, and was not pushed with.
void Mechanism::find_given(const Bodies& bodies) {
  std::fill(foreseen_.begin(), foreseen_.end(), JointImpulse{});
  for (std::size_t i = size(); i-- > 0;) {
    const auto body = static_cast<std::size_t>(tree_.node(i).body);
    JointImpulse& f = foreseen_[i];
    const Vector3d momentum = bodies.constants[body].mass * tree_.dv(i) - tree_.pushed_linear(i);
    f.v += momentum;
    f.w += bodies.inertia[body] * tree_.dw(i) - tree_.pushed_angular(i) + tree_.c(i).cross(momentum);
    if (tree_.node(i).parent < 0) continue;
    JointImpulse& up = foreseen_[static_cast<std::size_t>(tree_.node(i).parent)];
    up.v += f.v;
    up.w += f.w + tree_.r(i).cross(f.v);
  }
}

void Mechanism::note_ahead(const Bodies& bodies) {
  if (!predicts()) return;
  find_given(bodies);
  for (std::size_t i = 0; i < size(); ++i) prediction_.add_ahead(i, foreseen_[i]);
}

void Mechanism::note_after(const Bodies& bodies) {
  if (!predicts()) return;
  find_given(bodies);
  for (std::size_t i = 0; i < size(); ++i) prediction_.add_after(i, foreseen_[i]);
}

double Mechanism::largest_answer() const {
  double largest = 0.0;
  for (std::size_t i = 0; i < size(); ++i)
    largest = std::max({largest, tree_.dw(i).cwiseAbs().maxCoeff(), tree_.dv(i).cwiseAbs().maxCoeff()});
  return largest;
}

double Mechanism::largest_turn(const Bodies& bodies) const {
  double largest = 0.0;
  for (std::size_t i = 0; i < size(); ++i)
    largest = std::max(largest, bodies.w[static_cast<std::size_t>(body(i))].cwiseAbs().maxCoeff());
  return largest;
}

void Mechanism::nudge(Bodies& bodies, double h) const {
  for (std::size_t i = 0; i < size(); ++i)
    bodies.nudge(static_cast<std::size_t>(body(i)), h * tree_.dv(i), h * tree_.dw(i));
}

}  // namespace visum::dynamics::impulse

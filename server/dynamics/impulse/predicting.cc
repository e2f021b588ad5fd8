// How a mechanism foresees what its joints give (prediction.h), and learns what they gave. Symbols: tree.h.
//
// The foreseen impulse of a joint has no share along the directions in which the joint is free, except what
// drives give there. An error in it therefore does no work on the joints' motion, and the joints' gaps show
// all of it. Both bodies get it at the same point, so momentum is kept to rounding.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "server/dynamics/impulse/lanes/kernels.h"
#include "server/dynamics/impulse/mechanism.h"

namespace visum::dynamics::impulse {
namespace {

constexpr double kMostSwing = 1.5;  // rad in a step; a symmetric step follows 2 at most
// Links that hang together swing in more ways than about one axis, so there a tenth is allowed. With 0.6 rad
// the energy of some random chains of light links drifted a hundred times as far as with each link by itself.
constexpr double kMostSwingTogether = 0.15;

// A body that hangs on a joint swings about it under a tension F, as a bead on a string does. The frequency
// is 2 sqrt(F r / (m r^2 + J)), with r from the axis to the centre of mass. Returns its square over F,
// 1/(kg·m).
double square_of_swing(const BodyConstants& body, const Vector3d& lever, const Vector3d& axis) {
  const Vector3d across = lever - lever.dot(axis) * axis;
  const double moment = body.moments.dot(axis.cwiseAbs2()) + body.mass * across.squaredNorm();
  return 4.0 * across.norm() / moment;
}

// The same for any joint: 0 if it cannot turn, the larger of two axes if it can turn about several.
double square_of_swing(const BodyConstants& body, const Motion& free, const Vector3d& lever,
                       const Vector3d& axis) {
  if (free.count == 0 || free.w[0].isZero(0.0)) return 0.0;  // it cannot turn there
  if (free.count == 1) return square_of_swing(body, lever, axis);
  const Vector3d one = lever.unitOrthogonal(), other = lever.cross(one).normalized();
  return std::max(square_of_swing(body, lever, one), square_of_swing(body, lever, other));
}

}  // namespace

void Mechanism::start_predicting(const Bodies& bodies) {
  prediction_ = Prediction(size() + loops_.size());
  if (loops_.empty()) find_tautness(bodies);
}

void Mechanism::start_noting(const Bodies& bodies) {
  if (!loops_.empty()) return;
  noted_.resize(size());
  find_tautness(bodies);
}

void Mechanism::begin_step(double h) {
  prediction_.begin(h);
  std::ranges::fill(noted_, JointImpulse{});
}

void Mechanism::find_tautness(const Bodies& bodies) {
  tautness_.assign(size(), 0.0);
  for (std::size_t i = 0; i < size(); ++i) {
    const JointSpec* spec = carrying(i);
    if (spec == nullptr) continue;
    const auto of = [&](int number, const Vector3d& lever, const Vector3d& axis) {
      return square_of_swing(bodies.constants[static_cast<std::size_t>(number)], motions_[i], lever, axis);
    };
    tautness_[i] = of(spec->b, spec->point_b, spec->axis_b);
    if (spec->a >= 0) tautness_[i] = std::max(tautness_[i], of(spec->a, spec->point_a, spec->axis_a));
  }
}

// A light link between hinges that cross, as robots have them at hips and wrists, does not swing alone: what
// hangs on the next hinge turns with it. The response of the axis to an impulse on it counts all of that; the
// lever is then that of the farthest body. Without predictions the step closes what `iterate` has left: that
// is a part of the tension, and shorter steps are the more exact ones.
double Mechanism::square_of_swing_together(std::size_t i, const Bodies& bodies) {
  const Motion& free = motions_[i];
  if (free.count != 1 || free.w[0].isZero(0.0) || !predicts()) return tautness_[i];
  const TreePush on_axis = tree_.push_on_axis(i), nothing;
  swing_way_.clear();
  tree_.trace({&on_axis, 1}, {&nothing, 1}, swing_way_);
  const double response = Tree::response(swing_way_, swing_way_)(0, 0);
  const Vector3d axis = free.w[0].normalized();
  double lever = 0.0;
  // Parents come first, so that what hangs on it comes behind it.
  hangs_.assign(size(), 0);
  hangs_[i] = 1;
  for (std::size_t k = i; k < size(); ++k) {
    const int parent = tree_.node(k).parent;
    if (k > i && (parent < 0 || hangs_[static_cast<std::size_t>(parent)] == 0)) continue;
    hangs_[k] = 1;
    const Vector3d way = bodies.x[static_cast<std::size_t>(body(k))] - poses_[i].pb;
    lever = std::max(lever, (way - way.dot(axis) * axis).norm());
  }
  constexpr double kStricter = kMostSwing / kMostSwingTogether;
  return std::min(tautness_[i], 4.0 * kStricter * kStricter * lever * response);
}

// The impulse at t is half of what a step takes: F = 2 lambda/h. The sum over all joints is below the bound
// in most steps, and then no single joint can be above it.
bool Mechanism::is_too_taut(double h, const Bodies& bodies, WorkBudget& work) {
  if (tautness_.empty()) return false;  // with loops: not known
  const double most = 0.5 * kMostSwing * kMostSwing / std::abs(h);
  const std::span<const JointImpulse> given = predicts() ? prediction_.ahead() : noted_;
  const auto square = [&](const JointImpulse& one, double tautness) {
    return tautness * tautness * one.v.squaredNorm();
  };
  if (std::transform_reduce(given.begin(), given.end(), tautness_.begin(), 0.0, std::plus<>(), square) <=
      most * most)
    return false;
  for (std::size_t i = 0; i < given.size(); ++i) {
    if (square(given[i], tautness_[i]) <= most * most) continue;
    work.take(pass_units_);
    if (square(given[i], square_of_swing_together(i, bodies)) > most * most) return true;
  }
  return false;
}

bool Mechanism::predict(const Bodies& bodies) {
  if (!prediction_.is_ready() || !is_foreseeable()) return false;
  // Free roots give nothing. Hinges lose their share about the axis, the other kinds theirs along each free
  // direction.
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
  for (std::size_t i = 0; i < loops_.size(); ++i) hold_foreseen(i);
  return true;
}

// Rows that are left out get nothing. No gap would show an error along them, and it would grow from step to
// step.
void Mechanism::hold_foreseen(std::size_t i) {
  JointImpulse& foreseen = prediction_.foreseen()[size() + i];
  const JointImpulse f = foreseen;
  foreseen = {};
  for (std::size_t row = first_solved_[i]; row < first_solved_[i + 1]; ++row) {
    if (loop_factor_.is_left_out(row)) continue;
    const std::size_t k = solved_rows_[row] - first_loop_row_[i];
    const Vector3d &w = loop_held_[i].w[k], &v = loop_held_[i].v[k];
    const double share = (w.dot(f.w) + v.dot(f.v)) / (w.squaredNorm() + v.squaredNorm());
    foreseen.w += share * w;
    foreseen.v += share * v;
  }
}

// Adds an impulse on the coordinate of free direction k.
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
  if (!notes()) return apply(bodies);
  apply_and_note(bodies, predicts() ? prediction_.ahead() : noted_);
}

void Mechanism::apply_after(Bodies& bodies) {
  predicts() ? apply_and_note(bodies, prediction_.after()) : apply(bodies);
}

void Mechanism::apply_and_note(Bodies& bodies, std::span<JointImpulse> given) {
  tree_.apply_and_note(bodies, given.first(size()));
  for (std::size_t i = 0; i < solved_rows_.size(); ++i) {
    const std::size_t loop = loop_rows_[solved_rows_[i]].loop, k = solved_rows_[i] - first_loop_row_[loop];
    given[size() + loop].w += loop_errors_[i] * loop_held_[loop].w[k];
    given[size() + loop].v += loop_errors_[i] * loop_held_[loop].v[k];
  }
}

double Mechanism::largest_turn(const Bodies& bodies) const {
  return bodies.kernels().largest_turn(bodies.arrays(), blocks_.data(), blocks_.size());
}

void Mechanism::nudge(Bodies& bodies, double h) const {
  bodies.kernels().nudge(bodies.arrays(), blocks_.data(), blocks_.size(), h, tree_.answers()->dv,
                         tree_.answers()->w);
}

}  // namespace visum::dynamics::impulse

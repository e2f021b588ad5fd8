#include "server/dynamics/impulse/tree.h"

namespace visum::dynamics::impulse {

void Tree::clear() {
  for (Asked& asked : asked_) asked = {};
}

void Tree::clear_part(int part) {
  for (const std::size_t i : parts_[static_cast<std::size_t>(part)]) asked_[i] = {};
}

void Tree::solve_part(int part) {
  const std::vector<std::size_t>& nodes = parts_[static_cast<std::size_t>(part)];
  for (const std::size_t i : nodes) load(i);
  for (std::size_t k = nodes.size(); k-- > 0;) load_up(nodes[k]);
  for (const std::size_t i : nodes) spread_down(i);
}

void Tree::load(std::size_t i) {
  const Asked& asked = asked_[i];
  load_w_[i] = -asked.angular - factors_[i].c.cross(asked.linear);
  load_v_[i] = -asked.linear;
}

void Tree::solve() {
  for (std::size_t i = 0; i < size(); ++i) load(i);
  for (std::size_t i = size(); i-- > 0;) load_up(i);
  for (std::size_t i = 0; i < size(); ++i) spread_down(i);
}

// S^T p of one axis.
double Tree::along_axis(const Factor& f, const Vector3d& pw, const Vector3d& pv) {
  const double turn = f.axes[0].Sw.dot(pw);
  return f.turns_only ? turn : turn + f.axes[0].Sv.dot(pv);
}

// t = -D^-1 (S^T p - lambda) + gain b,  f = I (beta, alpha) + p + U t, handed to the parent.
void Tree::load_up(std::size_t i) {
  if (root_of_[i] >= 0) return;
  const Factor& f = factors_[i];
  const Asked& asked = asked_[i];
  const Vector3d &pw = load_w_[i], &pv = load_v_[i];
  auto& t = own_rates_[i];
  Vector3d fw = pw + f.A * asked.beta + f.B * asked.alpha;
  Vector3d fv = pv + f.B.transpose() * asked.beta + f.C * asked.alpha;
  if (f.dof == 1) {
    t[0] = f.gain * asked.target - f.inverse_D * (along_axis(f, pw, pv) - asked.axis_impulse);
    fw += t[0] * f.axes[0].Uw;
    fv += t[0] * f.axes[0].Uv;
  } else {
    const auto n = static_cast<std::size_t>(f.dof);
    std::array<double, 3> s{};
    for (std::size_t k = 0; k < n; ++k) s[k] = f.axes[k].Sw.dot(pw) + f.axes[k].Sv.dot(pv);
    for (std::size_t k = 0; k < n; ++k) {
      t[k] = 0.0;
      for (std::size_t l = 0; l < n; ++l)
        t[k] -= f.inverse_Ds(static_cast<int>(k), static_cast<int>(l)) * s[l];
      fw += t[k] * f.axes[k].Uw;
      fv += t[k] * f.axes[k].Uv;
    }
  }
  if (nodes_[i].parent < 0) return;
  const auto up = static_cast<std::size_t>(nodes_[i].parent);
  load_w_[up] += fw + f.r.cross(fv);
  load_v_[up] += fv;
}

void Tree::spread_root(std::size_t i) {
  Eigen::Matrix<double, 6, 1> load;
  load << load_w_[i], load_v_[i];
  const Eigen::Matrix<double, 6, 1> velocity = -roots_[static_cast<std::size_t>(root_of_[i])] * load;
  answer_[i].w = velocity.head<3>();
  answer_[i].v = velocity.tail<3>();
}

void Tree::spread_down(std::size_t i) {
  if (root_of_[i] >= 0)
    spread_root(i);
  else
    spread_joint(i);
  Answer& answer = answer_[i];
  answer.dv = answer.v + answer.w.cross(factors_[i].c);
}

// q' = t - D^-1 U^T (w1, v1),  (w1, v1) the velocity of P before the axes move.
void Tree::spread_joint(std::size_t i) {
  const Factor& f = factors_[i];
  Answer& answer = answer_[i];
  answer.w = asked_[i].beta;
  answer.v = asked_[i].alpha;
  if (nodes_[i].parent >= 0) {
    const Answer& up = answer_[static_cast<std::size_t>(nodes_[i].parent)];
    answer.w += up.w;
    answer.v += up.v + up.w.cross(f.r);
  }
  if (f.dof == 1) {
    const FreeAxis& axis = f.axes[0];
    answer.axis_load = axis.Uw.dot(answer.w) + axis.Uv.dot(answer.v);
    answer.rate = own_rates_[i][0] - f.inverse_D * answer.axis_load;
    answer.w += answer.rate * axis.Sw;
    if (!f.turns_only) answer.v += answer.rate * axis.Sv;
    return;
  }
  const auto n = static_cast<std::size_t>(f.dof);
  std::array<double, 3> load{}, rate{};
  for (std::size_t k = 0; k < n; ++k) load[k] = f.axes[k].Uw.dot(answer.w) + f.axes[k].Uv.dot(answer.v);
  for (std::size_t k = 0; k < n; ++k) {
    rate[k] = own_rates_[i][k];
    for (std::size_t l = 0; l < n; ++l)
      rate[k] -= f.inverse_Ds(static_cast<int>(k), static_cast<int>(l)) * load[l];
  }
  for (std::size_t k = 0; k < n; ++k) {
    answer.w += rate[k] * f.axes[k].Sw;
    answer.v += rate[k] * f.axes[k].Sv;
  }
}

// D q' + S^T p + U^T (w1, v1) = lambda: what the drive's part of it must have been.
double Tree::axis_impulse(std::size_t i) const {
  const Factor& f = factors_[i];
  if (!f.implicit) return 0.0;
  return f.D * answer_[i].rate + along_axis(f, load_w_[i], load_v_[i]) + answer_[i].axis_load -
         asked_[i].axis_impulse;
}

}  // namespace visum::dynamics::impulse

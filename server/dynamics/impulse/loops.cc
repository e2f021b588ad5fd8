// Closed loops on a spanning tree: G T^-1 G^T mu = e, with T^-1 the tree's response, G the rows that the
// loops hold, e what is left of them after the tree alone has answered. After Baraff, Linear-time dynamics
// using Lagrange multipliers, SIGGRAPH 1996, section 7 (auxiliary constraints).
#include "server/dynamics/impulse/mechanism.h"

namespace visum::dynamics::impulse {

Line line_at(const Mechanism& mechanism, const Bodies& bodies, int body_a, int body_b, const Vector3d& p,
             const Vector3d& w, const Vector3d& v) {
  Line line;
  if (body_a >= 0) {
    line.node_a = mechanism.node_of(body_a);
    line.angular_a = -w - (p - bodies.x[static_cast<std::size_t>(body_a)]).cross(v);
    line.linear_a = -v;
  }
  if (body_b >= 0) {
    line.node_b = mechanism.node_of(body_b);
    line.angular_b = w + (p - bodies.x[static_cast<std::size_t>(body_b)]).cross(v);
    line.linear_b = v;
  }
  return line;
}

void Mechanism::push(const Line& line, double impulse) {
  if (line.node_a >= 0)
    tree_.push_body(static_cast<std::size_t>(line.node_a), impulse * line.angular_a, impulse * line.linear_a);
  if (line.node_b >= 0)
    tree_.push_body(static_cast<std::size_t>(line.node_b), impulse * line.angular_b, impulse * line.linear_b);
}

double Mechanism::rate(const Line& line) const {
  double sum = 0.0;
  if (line.node_a >= 0) {
    const auto a = static_cast<std::size_t>(line.node_a);
    sum += line.angular_a.dot(tree_.dw(a)) + line.linear_a.dot(tree_.dv(a));
  }
  if (line.node_b >= 0) {
    const auto b = static_cast<std::size_t>(line.node_b);
    sum += line.angular_b.dot(tree_.dw(b)) + line.linear_b.dot(tree_.dv(b));
  }
  return sum;
}

void Mechanism::factor_loops(const Bodies& bodies) {
  loop_row_count_ = 0;
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    const Held& held = loop_held_[i];
    for (std::size_t k = 0; k < static_cast<std::size_t>(held.count); ++k)
      loop_rows_[loop_row_count_++].line =
          line_at(*this, bodies, loops_[i].a, loops_[i].b, loop_poses_[i].pb, held.w[k], held.v[k]);
  }
  loop_factor_.resize(loop_row_count_);
  for (std::size_t i = 0; i < loop_row_count_; ++i) {
    tree_.clear();
    push(loop_rows_[i].line, 1.0);
    tree_.solve();
    for (std::size_t j = 0; j < loop_row_count_; ++j) loop_factor_.at(i, j) = rate(loop_rows_[j].line);
  }
  loop_factor_.factor();
}

void Mechanism::solve() {
  tree_.solve();
  if (loop_row_count_ == 0) return;
  for (std::size_t i = 0; i < loop_row_count_; ++i)
    loop_errors_[i] = loop_rows_[i].wanted - rate(loop_rows_[i].line);
  loop_factor_.solve(loop_errors_);
  for (std::size_t i = 0; i < loop_row_count_; ++i) push(loop_rows_[i].line, loop_errors_[i]);
  tree_.solve();
}

}  // namespace visum::dynamics::impulse

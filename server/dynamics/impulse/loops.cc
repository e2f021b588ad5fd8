// Closed loops on a spanning tree: G T^-1 G^T mu = e. T^-1 is the tree's response, G the rows that the loops
// hold, and e what the loops still miss after the tree alone has answered. After Baraff, Linear-time dynamics
// using Lagrange multipliers, SIGGRAPH 1996, section 7 (auxiliary constraints). Two loops have a common entry
// only if they share a part of the tree, where a part is what hangs together without the ground. In a row of
// four-bars each loop has an entry with the next one only, and the cost grows with their number.
#include "server/dynamics/impulse/mechanism.h"

namespace visum::dynamics::impulse {
namespace {

constexpr double kNearlySingular =
    3e-4;  // share of a row's free response; a four-bar has it within 0.03 rad of the line

constexpr std::uint64_t kMostLoopRows = 6;  // that one joint holds

}  // namespace

// At each end: the torque about the centre of mass, and the force; A gets the opposite.
PathMotion line_at(const Mechanism& mechanism, const Bodies& bodies, int body_a, int body_b,
                   const Vector3d& p, const Vector3d& w, const Vector3d& v) {
  PathMotion line;
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

void Mechanism::push(const PathMotion& line, double impulse) {
  if (line.node_a >= 0)
    tree_.push_body(static_cast<std::size_t>(line.node_a), impulse * line.angular_a, impulse * line.linear_a);
  if (line.node_b >= 0)
    tree_.push_body(static_cast<std::size_t>(line.node_b), impulse * line.angular_b, impulse * line.linear_b);
}

double Mechanism::rate(const PathMotion& line) const {
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

std::array<int, 2> Mechanism::parts(const JointSpec& loop) const {
  const auto part = [&](int body) {
    return body < 0 ? -1 : tree_.part(static_cast<std::size_t>(node_of(body)));
  };
  return {part(loop.a), part(loop.b)};
}

void Mechanism::find_loop_neighbours() {
  first_neighbour_.resize(loops_.size());
  first_loop_row_.resize(loops_.size());
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    loop_parts_.push_back(parts(loops_[i]));
    const auto share = [&](std::size_t j) {
      for (const int part : loop_parts_[i])
        if (part >= 0 && (part == loop_parts_[j][0] || part == loop_parts_[j][1])) return true;
      return false;
    };
    // A loop shares a part with itself at the latest.
    first_neighbour_[i] = 0;
    while (!share(first_neighbour_[i])) ++first_neighbour_[i];
  }
}

// Each row of a loop is answered by the parts that its loop joins, at most by the whole tree, and is then
// eliminated by the rows before it, from its first neighbour's on.
void Mechanism::count_units() {
  std::vector<std::uint64_t> part_size(size(), 0);
  for (std::size_t node = 0; node < size(); ++node) ++part_size[static_cast<std::size_t>(tree_.part(node))];
  std::uint64_t answers = 0, entries = 0, products = 0;
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    for (const int part : loop_parts_[i])
      if (part >= 0) answers += kMostLoopRows * part_size[static_cast<std::size_t>(part)];
    const std::uint64_t width = kMostLoopRows * (i + 1 - first_neighbour_[i]);
    entries += kMostLoopRows * width;
    products += kMostLoopRows * width * width;
  }
  pass_units_ = WorkBudget::kPerNode * size() + 2 * entries / WorkBudget::kMultiplications;
  factor_units_ = WorkBudget::kPerNode * answers + entries + products / WorkBudget::kMultiplications;
}

double Mechanism::free_response(const PathMotion& line, const Bodies& bodies) const {
  const auto of = [&](int node, const Vector3d& angular, const Vector3d& linear) {
    if (node < 0) return 0.0;
    const auto body = static_cast<std::size_t>(tree_.node(static_cast<std::size_t>(node)).body);
    return angular.dot(bodies.inverse_inertia[body] * angular) +
           bodies.constants[body].inverse_mass * linear.squaredNorm();
  };
  return of(line.node_a, line.angular_a, line.linear_a) + of(line.node_b, line.angular_b, line.linear_b);
}

void Mechanism::place_loop_rows(const Bodies& bodies) {
  loop_row_count_ = 0;
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    // One row for each direction that a loop's joint holds.
    const Held& held = loop_held_[i];
    first_loop_row_[i] = loop_row_count_;
    for (std::size_t k = 0; k < static_cast<std::size_t>(held.count); ++k) {
      LoopRow& row = loop_rows_[loop_row_count_++];
      row.loop = i;
      row.line = line_at(*this, bodies, loops_[i].a, loops_[i].b, loop_poses_[i].pb, held.w[k], held.v[k]);
      row.free_response = free_response(row.line, bodies);
    }
  }
}

double Mechanism::rate_of_parts(const PathMotion& line, const std::array<int, 2>& parts) const {
  const auto among = [&](int node) {
    const int part = node < 0 ? -1 : tree_.part(static_cast<std::size_t>(node));
    return part >= 0 && (part == parts[0] || part == parts[1]);
  };
  // Bodies of other parts keep old answers, which must not count.
  PathMotion there = line;
  if (!among(line.node_a)) there.node_a = -1;
  if (!among(line.node_b)) there.node_b = -1;
  return rate(there);
}

// Response of a row to itself and to the rows before it. An impulse on it moves only the parts that its loop
// joins.
void Mechanism::find_response(std::size_t i, const std::array<int, 2>& parts) {
  // Both parts are pushed, then each is solved once.
  const bool two = parts[1] != parts[0];
  for (const int part : parts)
    if (part >= 0) tree_.clear_part(part);
  push(loop_rows_[i].line, 1.0);
  if (parts[0] >= 0) tree_.solve_part(parts[0]);
  if (parts[1] >= 0 && two) tree_.solve_part(parts[1]);
  for (std::size_t j = first_loop_row_[first_neighbour_[loop_rows_[i].loop]]; j <= i; ++j)
    loop_factor_.at(i, j) = rate_of_parts(loop_rows_[j].line, parts);
}

void Mechanism::factor_loops() {
  loop_factor_.clear();
  for (std::size_t i = 0; i < loop_row_count_; ++i) {
    const LoopRow& row = loop_rows_[i];
    if (i == first_loop_row_[row.loop]) loop_factor_.add_block(first_loop_row_[first_neighbour_[row.loop]]);
    loop_factor_.add_row(row.free_response);
    find_response(i, loop_parts_[row.loop]);
  }
  loop_factor_.factor();
}

bool Mechanism::is_nearly_singular() const {
  return !loops_.empty() && loop_factor_.least_share() < kNearlySingular;
}

void Mechanism::solve() {
  // The tree answers alone; the loops then add what is still missing, and the tree answers again.
  tree_.solve();
  if (loop_row_count_ == 0) return;
  for (std::size_t i = 0; i < loop_row_count_; ++i)
    loop_errors_[i] = loop_rows_[i].wanted - rate(loop_rows_[i].line);
  loop_factor_.solve(loop_errors_);
  for (std::size_t i = 0; i < loop_row_count_; ++i) push(loop_rows_[i].line, loop_errors_[i]);
  tree_.solve();
}

}  // namespace visum::dynamics::impulse

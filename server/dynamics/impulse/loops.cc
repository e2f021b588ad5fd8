// Closed loops on a spanning tree: G T^-1 G^T mu = e. T^-1 is the tree's response (tree_response.cc), G the
// rows that the loops hold, and e what the loops still miss after the tree alone has answered. After Baraff,
// Linear-time dynamics using Lagrange multipliers, SIGGRAPH 1996, section 7 (auxiliary constraints). Two
// loops have a common entry only if they share a part of the tree, where a part is what hangs together
// without the ground. In a row of four-bars each loop has an entry with the next one only, and the cost grows
// with their number.
#include "server/dynamics/impulse/mechanism.h"

namespace visum::dynamics::impulse {
namespace {

constexpr double kNearlySingular =
    3e-4;  // share of a row's free response; a four-bar has it within 0.03 rad of the line
constexpr double kForeseeable = 3e-3;  // the least such share with which joints are foreseen

// The most rows that one joint holds, in space and in a plane, their bundles, and products at a place.
constexpr std::uint64_t kMostLoopRows = 6, kMostPlanarRows = 2, kBundleProducts = 16;
constexpr std::uint64_t bundles_of(std::uint64_t rows) {
  return (rows + Tree::kMostTogether - 1) / Tree::kMostTogether;
}

}  // namespace

// At each end: the torque about the centre of mass, and the force; A gets the opposite.
PathMotion line_at(const PathEnds& ends, const Bodies& bodies, const Vector3d& p, const Vector3d& w,
                   const Vector3d& v) {
  PathMotion line;
  line.node_a = ends.node_a;
  line.node_b = ends.node_b;
  if (ends.node_a >= 0) {
    line.angular_a = -w - (p - bodies.x[static_cast<std::size_t>(ends.body_a)]).cross(v);
    line.linear_a = -v;
  }
  if (ends.node_b >= 0) {
    line.angular_b = w + (p - bodies.x[static_cast<std::size_t>(ends.body_b)]).cross(v);
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

std::array<int, 2> Mechanism::parts(const PathEnds& ends) const {
  const auto part = [&](int node) { return node < 0 ? -1 : tree_.part(static_cast<std::size_t>(node)); };
  return {part(ends.node_a), part(ends.node_b)};
}

void Mechanism::find_loop_neighbours() {
  first_neighbour_.resize(loops_.size());
  first_loop_row_.resize(loops_.size() + 1);
  first_solved_.resize(loops_.size() + 1);
  first_bundle_.resize(loops_.size());
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    loop_ends_.push_back({loops_[i].a, loops_[i].b, node_of(loops_[i].a), node_of(loops_[i].b)});
    loop_parts_.push_back(parts(loop_ends_[i]));
    loop_normals_.push_back(find_normal(i));
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

// The rows of a loop are followed through the parts that it joins, at most through the whole tree, and meet
// those of earlier loops there, from the first neighbour's on. By these they are then eliminated.
void Mechanism::count_units() {
  std::vector<std::uint64_t> part_size(size(), 0);  // places on the ways through it
  for (std::size_t node = 0; node < size(); ++node)
    part_size[static_cast<std::size_t>(tree_.part(node))] +=
        tree_.node(node).joint < 0 ? 6 : static_cast<std::uint64_t>(std::max(1, tree_.node(node).freedoms));
  const auto most_rows = [&](std::size_t i) { return is_planar(i) ? kMostPlanarRows : kMostLoopRows; };
  std::uint64_t steps = 0, entries = 0, products = 0;
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    std::uint64_t way = 0, width = 0, bundles = 0;
    for (const int part : loop_parts_[i])
      if (part >= 0) way += part_size[static_cast<std::size_t>(part)];
    for (std::size_t k = first_neighbour_[i]; k <= i; ++k) {
      width += most_rows(k);
      bundles += bundles_of(most_rows(k));
    }
    steps += bundles_of(most_rows(i)) * way;
    entries += most_rows(i) * width;
    products += most_rows(i) * width * width + kBundleProducts * bundles_of(most_rows(i)) * bundles * way;
  }
  pass_units_ = WorkBudget::kPerNode * size() + 2 * entries / WorkBudget::kMultiplications;
  factor_units_ = WorkBudget::kPerNode * steps + entries + products / WorkBudget::kMultiplications;
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
      row.line = line_at(loop_ends_[i], bodies, loop_pose(i).pb, held.w[k], held.v[k]);
      row.free_response = free_response(row.line, bodies);
    }
  }
  first_loop_row_[loops_.size()] = loop_row_count_;
}

// Follows the rows of a loop, four at a time. Rows that the tree cannot move at all are left out at once:
// LoopFactor would do so, too.
void Mechanism::trace_loop(std::size_t i) {
  first_bundle_[i] = bundles_.size();
  const std::size_t end = first_loop_row_[i + 1];
  for (std::size_t row = first_loop_row_[i]; row < end;) {
    std::array<TreePush, Tree::kMostTogether> a, b;
    std::size_t count = 0;
    for (; count < Tree::kMostTogether && row < end; ++row, ++count) {
      const PathMotion& line = loop_rows_[row].line;
      a[count] = tree_.push_at(line.node_a, line.angular_a, line.linear_a);
      b[count] = tree_.push_at(line.node_b, line.angular_b, line.linear_b);
    }
    Bundle bundle{.way = loop_ways_.size(), .first = solved_rows_.size()};
    tree_.trace(std::span(a).first(count), std::span(b).first(count), loop_ways_);
    bundle.places = loop_ways_.size() - bundle.way;
    const Eigen::Matrix4d W = response(bundle, bundle);
    for (std::size_t lane = 0; lane < count; ++lane) {
      const LoopRow& of = loop_rows_[row - count + lane];
      if (!(W(static_cast<int>(lane), static_cast<int>(lane)) > LoopFactor::kDependent * of.free_response))
        continue;
      bundle.lanes[bundle.rows++] = static_cast<int>(lane);
      solved_rows_.push_back(row - count + lane);
      loop_factor_.add_row(of.free_response);
    }
    if (bundle.rows == 0) {
      loop_ways_.resize(bundle.way);
      continue;
    }
    bundles_.push_back(bundle);
    enter(bundle, bundle, W);
  }
}

Eigen::Matrix4d Mechanism::response(const Bundle& a, const Bundle& b) const {
  const std::span<const Tree::WayPoint> ways(loop_ways_);
  return Tree::response(ways.subspan(a.way, a.places), ways.subspan(b.way, b.places));
}

// `b` comes no later than `a`.
void Mechanism::enter(const Bundle& a, const Bundle& b, const Eigen::Matrix4d& W) {
  for (std::size_t i = 0; i < a.rows; ++i)
    for (std::size_t j = 0; j < b.rows && b.first + j <= a.first + i; ++j)
      loop_factor_.at(a.first + i, b.first + j) = W(a.lanes[i], b.lanes[j]);
}

void Mechanism::factor_loops() {
  loop_factor_.clear();
  loop_ways_.clear();
  bundles_.clear();
  solved_rows_.clear();
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    first_solved_[i] = solved_rows_.size();
    loop_factor_.add_block(first_solved_[first_neighbour_[i]]);
    trace_loop(i);
    for (std::size_t a = first_bundle_[i]; a < bundles_.size(); ++a)
      for (std::size_t b = first_bundle_[first_neighbour_[i]]; b < a; ++b)
        enter(bundles_[a], bundles_[b], response(bundles_[a], bundles_[b]));
  }
  first_solved_[loops_.size()] = solved_rows_.size();
  loop_factor_.factor();
}

// In the pose itself the weak row is left out and does not count, so bars that stand there pass as sound.
bool Mechanism::is_nearly_singular() const {
  return !loops_.empty() && loop_factor_.least_share() < kNearlySingular;
}

bool Mechanism::is_foreseeable() const {
  return loops_.empty() || loop_factor_.least_share() >= kForeseeable;
}

void Mechanism::solve() {
  // The tree answers alone; the loops then add what is still missing, and the tree answers again.
  tree_.solve();
  if (solved_rows_.empty()) return;
  for (std::size_t i = 0; i < solved_rows_.size(); ++i) {
    const LoopRow& row = loop_rows_[solved_rows_[i]];
    loop_errors_[i] = row.wanted - rate(row.line);
  }
  loop_factor_.solve(loop_errors_);
  for (std::size_t i = 0; i < solved_rows_.size(); ++i)
    push(loop_rows_[solved_rows_[i]].line, loop_errors_[i]);
  tree_.solve();
}

// Row i of G T^-1 J^T is what the impulses J do to row i of the loops:
//   J (T^-1 - T^-1 G^T (G T^-1 G^T)^-1 G T^-1) J^T
void Mechanism::hold_responses(std::size_t n, double* W) {
  if (solved_rows_.empty()) return;
  held_.resize(solved_rows_.size() * n);
  for (const Bundle& bundle : bundles_)
    for (std::size_t i = 0; i < bundle.rows; ++i)
      tree_.find_responses_to(std::span(loop_ways_).subspan(bundle.way, bundle.places), bundle.lanes[i],
                              &held_[(bundle.first + i) * n]);
  loop_factor_.solve_lower(held_, n);
  for (std::size_t i = 0; i < n; ++i) {
    double* to = W + i * n;
    for (std::size_t row = 0; row < solved_rows_.size(); ++row) {
      const double* held = &held_[row * n];
      const double by = held[i];
      if (by == 0.0) continue;
      for (std::size_t j = 0; j <= i; ++j) to[j] -= by * held[j];
    }
    for (std::size_t j = 0; j < i; ++j) W[j * n + i] = to[j];
  }
}

// Holding them takes half of n² multiplications for each solved row, and saves n answers of the mechanism.
bool Mechanism::holds_responses_cheaply(std::size_t n) const {
  return solved_rows_.size() * n <= 2 * WorkBudget::kMultiplications * pass_units_;
}

}  // namespace visum::dynamics::impulse

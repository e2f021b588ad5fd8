#include "server/dynamics/impulse/mechanism.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "server/world/joint_kinds.h"
#include "server/world/joint_tree.h"

namespace visum::dynamics::impulse {
namespace {

bool is_ours(const world::WorldModel& model, const Bodies& bodies, world::JointId id) {
  const world::Joint& joint = model.joints[id.index()];
  return world::info(joint.kind).holds_anything && bodies.number(joint.child) >= 0;
}

// The representative of a body's connected part, by a forest of parents (union-find).
int representative(std::vector<int>& leader, int i) {
  const auto at = [&](int k) -> int& { return leader[static_cast<std::size_t>(k)]; };
  while (at(i) != i) i = at(i) = at(at(i));
  return i;
}

bool are_same(const std::vector<TreeAxis>& now, const std::vector<TreeAxis>& then) {
  return std::equal(now.begin(), now.end(), then.begin(), then.end(),
                    [](const TreeAxis& a, const TreeAxis& b) {
                      return a.implicit == b.implicit && a.compliance == b.compliance;
                    });
}

// Whether the joint's pose follows from where its bodies are, and from nothing that the world's state counts
// on (turns, a place along a curve).
bool is_of_bodies_alone(const JointSpec& joint) {
  return joint.kind != world::JointKind::kScrew && joint.kind != world::JointKind::kPointOnCurve;
}

}  // namespace

Mechanism::Mechanism(const world::WorldModel& model, const Bodies& bodies, std::vector<int> body_numbers,
                     const std::vector<world::JointId>& joints) {
  const std::vector<world::JointId> carrying = world::carrying_joints(model);
  std::vector<TreeNode> nodes;
  const auto node_with = [&](int body) {
    const auto found =
        std::find_if(nodes.begin(), nodes.end(), [&](const TreeNode& node) { return node.body == body; });
    return found == nodes.end() ? -1 : static_cast<int>(found - nodes.begin());
  };
  for (const int body : body_numbers) {
    if (carrying[bodies.constants[static_cast<std::size_t>(body)].id.index()].valid()) continue;
    nodes.push_back({body, -1, -1});
    specs_.emplace_back();
  }
  for (const world::JointId id : joints) {
    const JointSpec spec = make_spec(model, bodies, id);
    if (carrying[model.joints[id.index()].child.index()] != id) {
      loops_.push_back(spec);
      continue;
    }
    nodes.push_back({spec.b, spec.a < 0 ? -1 : node_with(spec.a), static_cast<int>(nodes.size())});
    specs_.push_back(spec);
  }
  poses_.resize(nodes.size());
  poses_ahead_.resize(nodes.size());
  motions_.resize(nodes.size());
  axes.resize(nodes.size());
  placed_axes_.resize(nodes.size());
  placed_x_.resize(nodes.size());
  placed_q_.resize(nodes.size());
  loop_poses_.resize(loops_.size());
  loop_poses_ahead_.resize(loops_.size());
  loop_held_.resize(loops_.size());
  loop_rows_.resize(6 * loops_.size());
  loop_errors_.resize(6 * loops_.size());
  for (std::size_t i = 0; i < nodes.size(); ++i)
    node_by_body_.emplace_back(nodes[i].body, static_cast<int>(i));
  std::sort(node_by_body_.begin(), node_by_body_.end());
  foreseen_.resize(nodes.size());
  foreseen_axis_.resize(nodes.size());
  unpushed_v_.resize(nodes.size());
  unpushed_w_.resize(nodes.size());
  of_bodies_alone_ = std::ranges::all_of(loops_, is_of_bodies_alone);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    of_bodies_alone_ = of_bodies_alone_ && (nodes[i].joint < 0 || is_of_bodies_alone(specs_[i]));
  tree_.assign(std::move(nodes));
  find_loop_neighbours();
}

int Mechanism::node_of(int body) const {
  const auto found = std::lower_bound(node_by_body_.begin(), node_by_body_.end(), std::pair{body, 0});
  return found != node_by_body_.end() && found->first == body ? found->second : -1;
}

bool Mechanism::is_placed(const Bodies& bodies) const {
  if (!placed_) return false;
  for (std::size_t i = 0; i < size(); ++i) {
    const auto body = static_cast<std::size_t>(tree_.node(i).body);
    if (bodies.x[body] != placed_x_[i] || bodies.q[body].coeffs() != placed_q_[i]) return false;
  }
  return true;
}

void Mechanism::remember(const Bodies& bodies) {
  for (std::size_t i = 0; i < size(); ++i) {
    const auto body = static_cast<std::size_t>(tree_.node(i).body);
    placed_x_[i] = bodies.x[body];
    placed_q_[i] = bodies.q[body].coeffs();
    placed_axes_[i] = axes[i];
  }
  placed_ = true;
  factored_ = false;
}

bool Mechanism::place(const Bodies& bodies, const world::WorldState& state) {
  const bool stands = is_placed(bodies);
  if (stands && of_bodies_alone_ && are_same(axes, placed_axes_)) return false;
  for (std::size_t i = 0; i < size(); ++i) {
    if (carrying(i) == nullptr || (stands && is_of_bodies_alone(specs_[i]))) continue;
    poses_[i] = pose_now(specs_[i], bodies, state.joints[specs_[i].id.index()].position);
    motions_[i] = motion_directions(specs_[i], poses_[i]);
  }
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    if (stands && is_of_bodies_alone(loops_[i])) continue;
    loop_poses_[i] = pose_now(loops_[i], bodies, state.joints[loops_[i].id.index()].position);
    loop_held_[i] = held_directions(loops_[i], loop_poses_[i]);
  }
  remember(bodies);
  return true;
}

void Mechanism::factor(const Bodies& bodies) {
  if (factored_) return;
  tree_.factor(bodies, poses_, motions_, axes);
  if (!loops_.empty()) {
    place_loop_rows(bodies);
    factor_loops();
  }
  factored_ = true;
}

double Mechanism::note_gap(const Gap& gap, const JointSpec& joint, double largest) {
  const double size = std::max(gap.turn.cwiseAbs().maxCoeff(), gap.shift.cwiseAbs().maxCoeff());
  if (size <= largest || std::isnan(largest)) return largest;
  worst_ = &joint;  // a NaN is the worst
  return size;
}

void Mechanism::place_ahead(const Bodies& bodies, const world::WorldState& state, double h) {
  for (std::size_t i = 0; i < size(); ++i)
    if (carrying(i) != nullptr)
      poses_ahead_[i] = impulse::pose_ahead(specs_[i], bodies, state.joints[specs_[i].id.index()], h);
  for (std::size_t i = 0; i < loops_.size(); ++i)
    loop_poses_ahead_[i] = impulse::pose_ahead(loops_[i], bodies, state.joints[loops_[i].id.index()], h);
}

double Mechanism::ask_gaps(double h) {
  double largest = -1.0;  // so that a joint without a gap is one to name, where an axis of it misses its aim
  for (std::size_t i = 0; i < size(); ++i) {
    if (carrying(i) == nullptr) continue;
    const Gap gap = joint_gap(specs_[i], poses_ahead_[i]);
    tree_.ask(i, gap.turn / h, gap.shift / h);
    largest = note_gap(gap, specs_[i], largest);
  }
  std::size_t row = 0;
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    const Gap gap = joint_gap(loops_[i], loop_poses_ahead_[i]);
    largest = note_gap(gap, loops_[i], largest);
    const Held& held = loop_held_[i];
    for (std::size_t k = 0; k < static_cast<std::size_t>(held.count); ++k)
      loop_rows_[row++].wanted = (held.w[k].dot(gap.turn) + held.v[k].dot(gap.shift)) / h;
  }
  return largest;
}

double Mechanism::ask_velocities(const Bodies& bodies) {
  double largest = 0.0;
  for (std::size_t i = 0; i < size(); ++i) {
    if (carrying(i) == nullptr) continue;
    const JointPose& pose = poses_[i];
    const auto b = static_cast<std::size_t>(specs_[i].b);
    Vector3d w = bodies.w[b], v = bodies.v[b] + bodies.w[b].cross(pose.pb - bodies.x[b]);
    if (specs_[i].a >= 0) {
      const auto a = static_cast<std::size_t>(specs_[i].a);
      w -= bodies.w[a];
      v -= bodies.v[a] + bodies.w[a].cross(pose.pb - bodies.x[a]);
    }
    // What the axes already do is no error: the rest must go.
    const Motion& free = motions_[i];
    if (free.count == 1) {
      const double rate =
          (free.w[0].dot(w) + free.v[0].dot(v)) / (free.w[0].squaredNorm() + free.v[0].squaredNorm());
      w -= rate * free.w[0];
      v -= rate * free.v[0];
    }
    tree_.ask(i, -w, -v);
    if (free.count <= 1) largest = std::max({largest, w.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff()});
  }
  for (std::size_t row = 0; row < loop_row_count_; ++row) {
    const Line& line = loop_rows_[row].line;
    double rate = 0.0;
    for (const auto& [node, angular, linear] : {std::tie(line.node_a, line.angular_a, line.linear_a),
                                                std::tie(line.node_b, line.angular_b, line.linear_b)}) {
      if (node < 0) continue;
      const auto body = static_cast<std::size_t>(tree_.node(static_cast<std::size_t>(node)).body);
      rate += angular.dot(bodies.w[body]) + linear.dot(bodies.v[body]);
    }
    loop_rows_[row].wanted = -rate;
    largest = std::max(largest, std::abs(rate));
  }
  return largest;
}

void Mechanism::clear() {
  tree_.clear();
  for (LoopRow& row : loop_rows_) row.wanted = 0.0;
}

void Mechanism::apply(Bodies& bodies) const {
  for (std::size_t i = 0; i < size(); ++i) {
    const auto body = static_cast<std::size_t>(tree_.node(i).body);
    bodies.v[body] += tree_.dv(i);
    bodies.w[body] += tree_.dw(i);
  }
}

std::vector<Mechanism> find_mechanisms(const world::WorldModel& model, const Bodies& bodies) {
  std::vector<int> leader(bodies.size());
  std::iota(leader.begin(), leader.end(), 0);
  std::vector<bool> jointed(bodies.size(), false);
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    if (!is_ours(model, bodies, {static_cast<std::int32_t>(i)})) continue;
    const int child = bodies.number(model.joints[i].child), parent = bodies.number(model.joints[i].parent);
    jointed[static_cast<std::size_t>(child)] = true;
    if (parent < 0) continue;
    jointed[static_cast<std::size_t>(parent)] = true;
    const int a = representative(leader, child), b = representative(leader, parent);
    leader[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  }
  // A body's representative is the lowest number of its part: one pass finds the parts in that order.
  std::vector<std::vector<int>> members(bodies.size());
  std::vector<std::vector<world::JointId>> joints(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (jointed[i])
      members[static_cast<std::size_t>(representative(leader, static_cast<int>(i)))].push_back(
          static_cast<int>(i));
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const world::JointId id{static_cast<std::int32_t>(i)};
    if (is_ours(model, bodies, id))
      joints[static_cast<std::size_t>(representative(leader, bodies.number(model.joints[i].child)))]
          .push_back(id);
  }
  std::vector<Mechanism> mechanisms;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (!members[i].empty()) mechanisms.emplace_back(model, bodies, members[i], joints[i]);
  return mechanisms;
}

}  // namespace visum::dynamics::impulse

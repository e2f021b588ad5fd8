#include "server/dynamics/impulse/mechanism.h"

#include <algorithm>
#include <cmath>

#include "server/dynamics/impulse/lanes/kernels.h"
#include "server/world/disjoint_sets.h"
#include "server/world/joint_kinds.h"
#include "server/world/joint_tree.h"

namespace visum::dynamics::impulse {
namespace {

// True if the joint holds something and moves a body of this engine.
bool is_ours(const world::WorldModel& model, const Bodies& bodies, world::JointId id) {
  const world::Joint& joint = model.joints[id.index()];
  return world::info(joint.kind).holds_anything && bodies.number(joint.child) >= 0;
}

// True if the joint's pose follows from its bodies alone. The others also need the world's state: a screw
// counts its turns, a point on a curve its place along it.
bool is_of_bodies_alone(const JointSpec& joint) {
  return joint.kind != world::JointKind::kScrew && joint.kind != world::JointKind::kPointOnCurve;
}

// Largest component of a gap, m or rad; NaN counts as the largest.
double gap_size(const Gap& gap) {
  double size = 0.0;
  for (const Vector3d& part : {gap.turn, gap.shift})
    for (const double number : part) size = larger(std::abs(number), size);
  return size;
}

template <typename Item>
constexpr long kNumbers = sizeof(Item) / sizeof(double);

}  // namespace

Mechanism::Mechanism(const world::WorldModel& model, const Bodies& bodies, std::vector<int> body_numbers,
                     const std::vector<world::JointId>& joints) {
  const std::vector<world::JointId> carrying = world::carrying_joints(model);
  // Nodes of the tree and their specs, built side by side.
  std::vector<TreeNode> nodes;
  const auto node_with = [&](int body) {
    const auto found =
        std::find_if(nodes.begin(), nodes.end(), [&](const TreeNode& node) { return node.body == body; });
    return found == nodes.end() ? -1 : static_cast<int>(found - nodes.begin());
  };
  // Bodies that no joint carries are free roots.
  for (const int body : body_numbers) {
    if (carrying[bodies.constants[static_cast<std::size_t>(body)].id.index()].valid()) continue;
    nodes.push_back({.body = body, .mass = bodies.constants[static_cast<std::size_t>(body)].mass});
    specs_.emplace_back();
  }
  // A joint that carries its child adds a node; any other joint closes a loop.
  for (const world::JointId id : joints) {
    const JointSpec spec = make_spec(model, bodies, id);
    if (carrying[model.joints[id.index()].child.index()] != id) {
      loops_.push_back(spec);
      continue;
    }
    nodes.push_back({.body = spec.b,
                     .parent = spec.a < 0 ? -1 : node_with(spec.a),
                     .joint = static_cast<int>(nodes.size()),
                     .freedoms = motion_directions(spec, pose_now(spec, bodies, 0.0)).count,
                     .mass = bodies.constants[static_cast<std::size_t>(spec.b)].mass});
    specs_.push_back(spec);
  }
  poses_.resize(nodes.size() + loops_.size());
  poses_ahead_.resize(poses_.size());
  motions_.resize(nodes.size());
  axes_.resize(nodes.size());
  loop_held_.resize(loops_.size());
  loop_rows_.resize(6 * loops_.size());
  loop_errors_.resize(6 * loops_.size());
  // Tables by body, and blocks for the kernels, which write to the tree's answers directly.
  for (std::size_t i = 0; i < nodes.size(); ++i)
    node_by_body_.emplace_back(nodes[i].body, static_cast<int>(i));
  std::sort(node_by_body_.begin(), node_by_body_.end());
  foreseen_axis_.resize(nodes.size());
  // Poses may be kept between steps only if all of them follow from the bodies.
  of_bodies_alone_ = std::ranges::all_of(loops_, is_of_bodies_alone);
  for (std::size_t i = 0; i < nodes.size(); ++i)
    of_bodies_alone_ = of_bodies_alone_ && (nodes[i].joint < 0 || is_of_bodies_alone(specs_[i]));
  std::vector<int> numbers;
  for (const TreeNode& node : nodes) numbers.push_back(node.body);
  blocks_ = bodies.blocks_of(numbers);
  tree_.assign(std::move(nodes));
  for (BodyBlock& block : blocks_)
    for (long& answer : block.answer) answer = tree_.answer(static_cast<std::size_t>(answer));
  find_blocks(bodies);
  find_loop_neighbours();
  count_units();
}

void Mechanism::find_blocks(const Bodies& bodies) {
  std::vector<std::size_t> hinge_nodes;
  for (std::size_t i = 0; i < size(); ++i) {
    if (carrying(i) == nullptr) {
      free_roots_.push_back(i);
      continue;
    }
    // Hinges have kernels of their own, all other kinds share one.
    (specs_[i].kind == world::JointKind::kHinge ? hinge_nodes : other_nodes_).push_back(i);
    poses_[i] = pose_now(specs_[i], bodies, 0.0);
    poses_ahead_[i] = impulse::pose_ahead(specs_[i], bodies, {}, 0.0);
    motions_[i] = motion_directions(specs_[i], poses_[i]);
    add_ends(specs_[i], i, bodies);
  }
  for (std::size_t i = 0; i < loops_.size(); ++i) add_ends(loops_[i], size() + i, bodies);
  hinges_ = joint_blocks(hinge_nodes, bodies);
  others_ = joint_blocks(other_nodes_, bodies);
}

// Offsets are counted in doubles, as kernels want them.
void Mechanism::add_ends(const JointSpec& spec, std::size_t place, const Bodies& bodies) {
  JointEnds& ends = ends_.emplace_back();
  ends.pose = static_cast<long>(place) * kNumbers<JointPose>;
  ends.impulse = static_cast<long>(place) * kNumbers<JointImpulse>;
  ends.vector_b = 3L * spec.b;
  ends.matrix_b = 9L * spec.b;
  ends.inverse_mass_b = bodies.constants[static_cast<std::size_t>(spec.b)].inverse_mass;
  ends.has_a = spec.a >= 0;
  if (!ends.has_a) return;
  ends.vector_a = 3L * spec.a;
  ends.matrix_a = 9L * spec.a;
  ends.inverse_mass_a = bodies.constants[static_cast<std::size_t>(spec.a)].inverse_mass;
}

std::vector<JointBlock> Mechanism::joint_blocks(const std::vector<std::size_t>& nodes,
                                                const Bodies& bodies) const {
  std::vector<JointBlock> blocks((nodes.size() + 3) / 4);
  // A last block that is not full repeats its last joint.
  for (std::size_t i = 0; i < 4 * blocks.size(); ++i) {
    JointBlock& block = blocks[i / 4];
    const std::size_t node = nodes[std::min(i, nodes.size() - 1)], lane = i % 4;
    const JointSpec& spec = specs_[node];
    for (int k = 0; k < 3; ++k) {
      block.point_a[k][lane] = spec.point_a[k];
      block.axis_a[k][lane] = spec.axis_a[k];
      block.point_b[k][lane] = spec.point_b[k];
      block.axis_b[k][lane] = spec.axis_b[k];
    }
    const int a = spec.a < 0 ? bodies.still() : spec.a;
    // Where the kernels find the bodies and the joint, in numbers.
    block.vector_a[lane] = 3L * a;
    block.matrix_a[lane] = 9L * a;
    block.vector_b[lane] = 3L * spec.b;
    block.matrix_b[lane] = 9L * spec.b;
    const auto number = static_cast<long>(node);
    block.node[lane] = number;
    block.pose[lane] = number * kNumbers<JointPose>;
    block.free[lane] = number * kNumbers<Motion>;
    block.impulse[lane] = number * kNumbers<JointImpulse>;
    block.request[lane] = tree_.request(node);
  }
  return blocks;
}

int Mechanism::node_of(int body) const {
  const auto found = std::lower_bound(node_by_body_.begin(), node_by_body_.end(), std::pair{body, 0});
  return found != node_by_body_.end() && found->first == body ? found->second : -1;
}

bool Mechanism::place(const Bodies& bodies, const world::WorldState& state) {
  // Poses stay valid as long as no body has moved; poses that need the world's state are made anew.
  const bool stands = placed_at_ == bodies.placements();
  if (stands && of_bodies_alone_ && !axes_changed_) return false;
  const BodyArrays& of = bodies.arrays();
  // Points and axes of all joints in the tree, and the free directions of hinges.
  if (!stands) {
    bodies.kernels().place_hinges(of.x, of.R, hinges_.data(), hinges_.size(), poses_[0].pa.data(),
                                  motions_[0].w[0].data());
    bodies.kernels().place_joints(of.x, of.R, others_.data(), others_.size(), poses_[0].pa.data());
  }
  // Angles and free directions of the other kinds are computed one by one.
  for (const std::size_t i : other_nodes_) {
    if (stands && is_of_bodies_alone(specs_[i])) continue;
    find_angle(specs_[i], state.joints[specs_[i].id.index()].position, poses_[i]);
    motions_[i] = motion_directions(specs_[i], poses_[i]);
  }
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    if (stands && is_of_bodies_alone(loops_[i])) continue;
    JointPose& pose = poses_[size() + i];
    pose = pose_now(loops_[i], bodies, state.joints[loops_[i].id.index()].position);
    loop_held_[i] = held_by_loop(i);
  }
  axes_changed_ = false;
  placed_at_ = bodies.placements();
  factored_ = false;
  return true;
}

void Mechanism::factor(const Bodies& bodies) {
  if (factored_) return;
  tree_.factor(bodies, poses_, motions_, axes_);
  if (!loops_.empty()) {
    // The loops need the factored tree.
    place_loop_rows(bodies);
    factor_loops();
  }
  factored_ = true;
}

double Mechanism::ask_gaps(const Bodies& bodies, const world::WorldState& state, double h) {
  // Hinges ask by themselves; the other kinds are asked one by one.
  const BodyArrays& of = bodies.arrays();
  double largest = bodies.kernels().ask_hinges_gaps(of.x1, of.R1, hinges_.data(), hinges_.size(), h,
                                                    poses_ahead_[0].pa.data(), tree_.asks());
  bodies.kernels().place_joints(of.x1, of.R1, others_.data(), others_.size(), poses_ahead_[0].pa.data());
  for (const std::size_t i : other_nodes_) {
    find_angle(specs_[i], position_ahead(specs_[i], state.joints[specs_[i].id.index()], h), poses_ahead_[i]);
    const Gap gap = joint_gap(specs_[i], poses_ahead_[i]);
    tree_.ask(i, gap.turn / h, gap.shift / h);
    largest = larger(gap_size(gap), largest);
  }
  // Loops: the directions that they hold are those at t.
  std::size_t row = 0;
  for (std::size_t i = 0; i < loops_.size(); ++i) {
    JointPose& pose = poses_ahead_[size() + i];
    pose = impulse::pose_ahead(loops_[i], bodies, state.joints[loops_[i].id.index()], h);
    const Gap gap = joint_gap(loops_[i], pose);
    largest = larger(gap_size(gap), largest);
    const Held& held = loop_held_[i];
    for (std::size_t k = 0; k < static_cast<std::size_t>(held.count); ++k)
      loop_rows_[row++].wanted = (held.w[k].dot(gap.turn) + held.v[k].dot(gap.shift)) / h;
  }
  return largest;
}

const JointSpec* Mechanism::worst_joint() const {
  const JointSpec* worst = nullptr;
  double largest = -1.0;  // joints without a gap can still be named, where an axis misses its aim
  // A NaN counts as the largest gap.
  const auto look = [&](const JointSpec& joint, const JointPose& pose) {
    const double gap = gap_size(joint_gap(joint, pose));
    if (gap <= largest || std::isnan(largest)) return;
    largest = gap;
    worst = &joint;
  };
  for (std::size_t i = 0; i < size(); ++i)
    if (carrying(i) != nullptr) look(specs_[i], poses_ahead_[i]);
  for (std::size_t i = 0; i < loops_.size(); ++i) look(loops_[i], loop_pose_ahead(i));
  return worst;
}

void Mechanism::ask_velocities(const Bodies& bodies) {
  bodies.kernels().ask_hinges_velocities(bodies.arrays(), hinges_.data(), hinges_.size(), poses_[0].pa.data(),
                                         tree_.asks());
  for (const std::size_t i : other_nodes_) {
    const JointPose& pose = poses_[i];
    const auto b = static_cast<std::size_t>(specs_[i].b);
    // Relative velocity of B against A, both at P.
    Vector3d w = bodies.w[b], v = bodies.v[b] + bodies.w[b].cross(pose.pb - bodies.x[b]);
    if (specs_[i].a >= 0) {
      const auto a = static_cast<std::size_t>(specs_[i].a);
      w -= bodies.w[a];
      v -= bodies.v[a] + bodies.w[a].cross(pose.pb - bodies.x[a]);
    }
    // The motion along the joint's own axis is no error, the rest must go. The rate is the one that drives
    // use: of a screw the rate of its turn.
    const Motion& free = motions_[i];
    if (free.count == 1) {
      const bool turns = !free.w[0].isZero(0.0);
      const Vector3d& along = turns ? free.w[0] : free.v[0];
      const double rate = along.dot(turns ? w : v) / along.squaredNorm();
      w -= rate * free.w[0];
      v -= rate * free.v[0];
    }
    tree_.ask(i, -w, -v);
  }
  // The present velocity along each row of a loop, with the opposite sign.
  for (std::size_t row = 0; row < loop_row_count_; ++row) {
    const PathMotion& line = loop_rows_[row].line;
    double rate = 0.0;
    for (const auto& [node, angular, linear] : {std::tie(line.node_a, line.angular_a, line.linear_a),
                                                std::tie(line.node_b, line.angular_b, line.linear_b)}) {
      if (node < 0) continue;
      const auto body = static_cast<std::size_t>(tree_.node(static_cast<std::size_t>(node)).body);
      rate += angular.dot(bodies.w[body]) + linear.dot(bodies.v[body]);
    }
    loop_rows_[row].wanted = -rate;
  }
}

void Mechanism::clear() {
  tree_.clear();
  for (LoopRow& row : loop_rows_) row.wanted = 0.0;
}

std::vector<Mechanism> find_mechanisms(const world::WorldModel& model, const Bodies& bodies) {
  // Joins the parts of parent and child of every joint.
  world::DisjointSets parts(bodies.size());
  std::vector<bool> jointed(bodies.size(), false);
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    if (!is_ours(model, bodies, {static_cast<std::int32_t>(i)})) continue;
    const int child = bodies.number(model.joints[i].child), parent = bodies.number(model.joints[i].parent);
    jointed[static_cast<std::size_t>(child)] = true;
    if (parent < 0) continue;
    jointed[static_cast<std::size_t>(parent)] = true;
    parts.join(static_cast<std::size_t>(child), static_cast<std::size_t>(parent));
  }
  // A part's leader is its lowest body, so one pass finds the parts in that order.
  std::vector<std::vector<int>> members(bodies.size());
  std::vector<std::vector<world::JointId>> joints(bodies.size());
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (jointed[i]) members[parts.leader(i)].push_back(static_cast<int>(i));
  for (std::size_t i = 0; i < model.joints.size(); ++i) {
    const world::JointId id{static_cast<std::int32_t>(i)};
    if (is_ours(model, bodies, id))
      joints[parts.leader(static_cast<std::size_t>(bodies.number(model.joints[i].child)))].push_back(id);
  }
  std::vector<Mechanism> mechanisms;
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (!members[i].empty()) mechanisms.emplace_back(model, bodies, members[i], joints[i]);
  return mechanisms;
}

}  // namespace visum::dynamics::impulse

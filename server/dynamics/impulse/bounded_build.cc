// How the rows of a moment are made and connected to bodies and mechanisms.
#include <algorithm>
#include <cmath>

#include "server/dynamics/impulse/bounded.h"

namespace visum::dynamics::impulse {

namespace {

// A direction of six numbers: angular, then linear.
auto angular(const std::array<double, 6>& row) {
  return Eigen::Map<const Vector3d>(row.data());
}
auto linear(const std::array<double, 6>& row) {
  return Eigen::Map<const Vector3d>(row.data() + 3);
}
void put(std::array<double, 6>& row, const Vector3d& angular, const Vector3d& linear) {
  Eigen::Map<Vector3d>(row.data()) = angular;
  Eigen::Map<Vector3d>(row.data() + 3) = linear;
}

// The most steps of the rows' ways to the root, per body of the tree. With more, answers of the whole tree
// cost less than comparing all ways.
constexpr std::size_t kMostWaySteps = 60;
// An answer is dear if it takes a quarter of what a tick may take. A tick has two of them, and each goes on
// to the end of its point.
constexpr std::uint64_t kDearShare = 4;
constexpr double kStandingSteps = 2.0;  // of falling: what moves faster does not stand
constexpr double kManyLayers = 64.0;    // of a heap: to take all overlaps out at once would throw it up
constexpr double kCalmM = 1e-5;         // a deeper overlap is a hit whose bodies are still driven apart

// The impulses of the last tick. At the end of a step a stop may take back what it gave at t, and no more.
double start_of_stop(const Axis& axis, std::size_t side, Moment moment) {
  const Axis::KeptStop& kept = axis.kept_stops[side];
  const double ahead = axis.stopped[side][kAhead], after = ahead + kept.change;
  if (moment != kAfter) return moment == kAhead ? kept.impulse : 0.0;
  return side == 0 ? std::max(after, -ahead) : std::min(after, -ahead);
}

}  // namespace

Bounded::Bounded(Plant& plant, WorkBudget& work)
    : plant_(plant),
      work_(work),
      rows_(kernels(), &work),
      place_(plant.mechanisms.size()),
      slot_(plant.bodies.size(), kNone) {}

// Forgets the rows of the last moment.
void Bounded::reset() {
  blocks_.clear();
  bodies_.clear();
  owners_.clear();
  if (of_mechanism_.size() < mechanisms().size()) of_mechanism_.resize(mechanisms().size());
  for (std::size_t k = 0; k < mechanisms().size(); ++k) {
    place_[mechanisms()[k]] = k;
    of_mechanism_[k].rows.clear();
  }
  for (const std::size_t body : slotted_) slot_[body] = kNone;
  slotted_.clear();
}

void Bounded::build(std::size_t island, Moment moment, double h, Course& course) {
  island_ = island;
  moment_ = moment;
  h_ = h;
  course_ = &course;
  if (moment != kAfter) course = {};
  reset();
  add_rows();
  mark_bound();
  lay_out();
  system_ = {blocks_, velocities_, bodies_, responses_};
  system_.calm = is_calm();
  // Errors of rest would add up, so what stands is solved exactly.
  system_.moves = moment != kHit && !stands();
  system_.dear = std::max<std::uint64_t>(1, plant_.work.limit() / kDearShare);  // it divides
  if (!responses_.empty()) connect_responses();
  before_.resize(blocks_.size());
  rows_.prepare(system_);
  at_once_ = moment == kAhead && !system_.moves && !carries_many();
  let_wedges_yield();
}

bool Bounded::is_calm() const {
  return std::ranges::all_of(plant_.islands.touches(island_),
                             [&](std::size_t i) { return plant_.touches[i].depth < kCalmM; });
}

bool Bounded::stands() const {
  const double fastest = kStandingSteps * plant_.model.gravity.norm() * std::abs(h_);
  return std::ranges::all_of(slotted_, [&](std::size_t i) { return plant_.bodies.v[i].norm() <= fastest; });
}

// Under n cubes, the impulse at a cube's corner alone would change that corner's velocity by about n times
// what a body falls in a step.
bool Bounded::carries_many() const {
  const double most = kManyLayers * plant_.model.gravity.norm() * std::abs(h_);
  return std::ranges::any_of(blocks_, [&](const RowBlock& block) {
    return block.kind == RowBlock::Kind::kContact && block.K[0] * block.lambda[0] > most;
  });
}

void Bounded::add_rows() {
  const Islands& islands = plant_.islands;
  work_.take(WorkBudget::kPerTouch * (islands.touches(island_).size() + islands.springs(island_).size()));
  for (const std::size_t i : islands.touches(island_)) add_touch(i);
  // Axes that are not in the tree, or that are near a stop.
  for (const std::size_t m : mechanisms()) {
    const std::size_t first = plant_.first_acting[m], end = plant_.first_acting[m + 1];
    work_.take(WorkBudget::kPerTouch * (end - first));
    for (std::size_t k = first; k < end; ++k) {
      const Axis& axis = plant_.axes[plant_.acting[k]];
      if (axis.boxed || axis.loop >= 0 || is_within_reach(axis, h_)) add_axis(plant_.acting[k]);
    }
  }
  // Springs are solved in the look-ahead only.
  if (moment_ == kAhead)
    for (const std::size_t i : islands.springs(island_)) add_spring(i);
}

RowBlock& Bounded::add_block(Owner owner, std::size_t dim) {
  owners_.push_back(owner);
  RowBlock& block = blocks_.emplace_back();
  block.dim = dim;
  return block;
}

// `find_a` and `find_b` set an end's J and what follows from it (Rows::respond()). For a body without joints
// they write into the block itself, which avoids a copy.
template <typename FindA, typename FindB>
void Bounded::connect_bodies(RowBlock& block, int a, int b, FindA find_a, FindB find_b) {
  const int of_a = a < 0 || apart_ ? -1 : plant_.places[static_cast<std::size_t>(a)].mechanism;
  const int of_b = b < 0 || apart_ ? -1 : plant_.places[static_cast<std::size_t>(b)].mechanism;
  // Both bodies have no joints, or do not move.
  if (of_a < 0 && of_b < 0) {
    if (a >= 0) find_a(block, add_free_end(block, static_cast<std::size_t>(a)));
    if (b >= 0) find_b(block, add_free_end(block, static_cast<std::size_t>(b)));
    return;
  }
  // At least one is part of a mechanism: only its directions are needed there.
  RowBlock alone;
  alone.dim = block.dim;
  RowEnd at_a, at_b;
  if (of_a >= 0) find_a(alone, at_a);
  if (of_b >= 0) find_b(alone, at_b);
  // Both bodies in one mechanism: one end that moves both.
  if (of_a >= 0 && of_a == of_b) return connect_mechanism(block, a, &at_a.J, b, &at_b.J);
  if (of_a >= 0)
    connect_mechanism(block, a, &at_a.J, -1, nullptr);
  else if (a >= 0)
    find_a(block, add_free_end(block, static_cast<std::size_t>(a)));
  if (of_b >= 0)
    connect_mechanism(block, -1, nullptr, b, &at_b.J);
  else if (b >= 0)
    find_b(block, add_free_end(block, static_cast<std::size_t>(b)));
}

RowEnd& Bounded::add_free_end(RowBlock& block, std::size_t body) {
  // The body's first row gives it six velocities and its mass.
  if (slot_[body] == kNone) {
    slot_[body] = 6 * slotted_.size();
    slotted_.push_back(body);
    FreeBody& free = bodies_.emplace_back();
    free.mass = plant_.bodies.constants[body].mass;
    const Matrix3d& inertia = plant_.bodies.inertia[body];
    std::copy(inertia.data(), inertia.data() + 9, free.inertia.begin());
  }
  RowEnd& end = block.ends[block.end_count++];
  end.offset = slot_[body];
  return end;
}

void Bounded::respond(RowBlock& block, RowEnd& end, int body) const {
  const auto i = static_cast<std::size_t>(body);
  rows_.respond(block, end, plant_.bodies.inverse_inertia[i].data(), plant_.bodies.constants[i].inverse_mass);
}

void Bounded::add_touch(std::size_t index) {
  const Touch& touch = plant_.touches[index];
  if (touch.asleep) return;
  if (touch.foreseen && moment_ != kAhead) return;
  RowBlock& block = add_block({Of::kTouch, index}, 3);
  block.kind = RowBlock::Kind::kContact;
  // Contacts yield a little, except in a hit, which must bounce exactly. The start is the last impulse.
  block.give = moment_ != kHit ? kGive : 0.0;
  if (moment_ == kAfter) block.rest = touch.impulse[kAhead][0];
  for (int i = 0; i < 3; ++i) block.lambda[static_cast<std::size_t>(i)] = touch.impulse[moment_][i];
  for (const int body : {touch.a, touch.b})
    if (body >= 0)
      block.free_response += plant_.bodies.constants[static_cast<std::size_t>(body)].inverse_mass;
  const auto find = [&](RowBlock& of, RowEnd& end, int body, const Vector3d& lever, double sign) {
    // A mechanism needs the directions alone.
    if (plant_.places[static_cast<std::size_t>(body)].mechanism >= 0 && !apart_) {
      for (std::size_t row = 0; row < 3; ++row) {
        const Vector3d along = sign * touch.frame.col(static_cast<int>(row));
        put(end.J[row], lever.cross(along), along);
      }
      return;
    }
    const auto i = static_cast<std::size_t>(body);
    rows_.respond_at_point(of, end, touch.frame.data(), lever.data(), sign,
                           plant_.bodies.inverse_inertia[i].data(), plant_.bodies.constants[i].inverse_mass);
  };
  connect_bodies(
      block, touch.a, touch.b, [&](RowBlock& of, RowEnd& end) { find(of, end, touch.a, touch.ra, 1.0); },
      [&](RowBlock& of, RowEnd& end) { find(of, end, touch.b, touch.rb, -1.0); });
  if (is_held_from_turning(touch)) add_twist(index);
}

// Must come right after its contact, whose normal impulse bounds it.
void Bounded::add_twist(std::size_t index) {
  const Touch& touch = plant_.touches[index];
  RowBlock& block = add_block({Of::kTwist, index}, 3);
  block.kind = RowBlock::Kind::kTwist;
  block.contact = blocks_.size() - 2;
  block.friction = touch.rolling_friction;
  block.torsion = touch.torsional_friction;
  for (int i = 0; i < 3; ++i) block.lambda[static_cast<std::size_t>(i)] = touch.twist[moment_][i];
  // Mean inverse moment of the bodies: the measure of a free response.
  for (const int body : {touch.a, touch.b})
    if (body >= 0)
      block.free_response +=
          plant_.bodies.constants[static_cast<std::size_t>(body)].inverse_moments.sum() / 3.0;
  const auto find = [&](RowBlock& of, RowEnd& end, int body, double sign) {
    for (std::size_t i = 0; i < 3; ++i)
      put(end.J[i], sign * touch.frame.col(static_cast<int>(i)), Vector3d::Zero());
    respond(of, end, body);
  };
  connect_bodies(
      block, touch.a, touch.b, [&](RowBlock& of, RowEnd& end) { find(of, end, touch.a, 1.0); },
      [&](RowBlock& of, RowEnd& end) { find(of, end, touch.b, -1.0); });
}

void Bounded::add_axis(std::size_t index) {
  const Axis& axis = plant_.axes[index];
  if (axis.boxed) add_law(index);
  if (axis.loop >= 0 && axis.damping > 0.0 && moment_ != kHit)
    connect_axis(add_block({Of::kDamping, index}, 1), axis);
  for (const std::size_t side : {0u, 1u})
    if (is_within_reach(axis, side, h_)) add_stop(index, side);
}

void Bounded::add_law(std::size_t index) {
  const Axis& axis = plant_.axes[index];
  RowBlock& block = add_block({Of::kLaw, index}, 1);
  block.lambda[0] = moment_ == kAhead ? 0.5 * h_ * axis.expected : axis.law[kAhead];
  connect_axis(block, axis);
}

// At the end of the step a stop takes part only if it has pushed at t, or if the look-ahead has reached it.
void Bounded::add_stop(std::size_t index, std::size_t side) {
  const Axis& axis = plant_.axes[index];
  // In a hit only the stops that find_hits() has marked.
  const double sign = side == 0 ? -1.0 : 1.0;
  if (moment_ == kHit && !axis.hits[side]) return;
  if (moment_ == kAfter && axis.stopped[side][kAhead] == 0.0 && room(axis, side) > h_ * sign * axis.mean_rate)
    return;
  RowBlock& block = add_block({Of::kStop, index, side}, 1);
  // Where a law holds the axis, next to nothing moves the row, and what it starts from would stay.
  if (!law_in_tree(axis)) block.lambda[0] = start_of_stop(axis, side, moment_);
  connect_axis(block, axis);
}

void Bounded::add_spring(std::size_t index) {
  const JointSpec& spec = plant_.springs[index].spec;
  const Pull& pull = plant_.springs[index].pull;
  const Vector3d &w = pull.w, &v = pull.v, &pa = pull.pa, &pb = pull.pb;
  if (!plant_.springs[index].acts || !plant_.is_loose(plant_.springs[index])) return;
  RowBlock& block = add_block({Of::kSpring, index}, 1);
  const auto find = [&](RowBlock& of, RowEnd& end, int body, const Vector3d& at, double sign) {
    // J of a pull along (w, v) at a point: the torque about the centre of mass, and the force.
    const Vector3d lever = at - plant_.bodies.x[static_cast<std::size_t>(body)];
    put(end.J[0], sign * (w + lever.cross(v)), sign * v);
    respond(of, end, body);
  };
  connect_bodies(
      block, spec.a, spec.b, [&](RowBlock& of, RowEnd& end) { find(of, end, spec.a, pa, -1.0); },
      [&](RowBlock& of, RowEnd& end) { find(of, end, spec.b, pb, 1.0); });
}

void Bounded::connect_axis_apart(RowBlock& block, const Axis& axis) {
  const AxisDirection along = axis_direction(*axis.spec, *axis.pose);
  const auto find = [&](RowBlock& of, RowEnd& end, int body, double sign) {
    const Vector3d lever = axis.pose->pb - plant_.bodies.x[static_cast<std::size_t>(body)];
    put(end.J[0], sign * (along.w + lever.cross(along.v)), sign * along.v);
    respond(of, end, body);
  };
  connect_bodies(
      block, axis.a, axis.b, [&](RowBlock& of, RowEnd& end) { find(of, end, axis.a, -1.0); },
      [&](RowBlock& of, RowEnd& end) { find(of, end, axis.b, 1.0); });
  block.free_response = block.K[0];
}

void Bounded::connect_axis(RowBlock& block, const Axis& axis) {
  if (apart_) return connect_axis_apart(block, axis);
  MechanismRows& rows = rows_of(axis.mechanism);
  add_mechanism_end(block, static_cast<int>(axis.mechanism));
  // An axis of the tree is pushed directly.
  if (axis.node >= 0) {
    rows.rows.push_back({.axis = &axis});
    return;
  }
  // An axis that closes a loop is a motion between two bodies of the tree.
  const Mechanism& mechanism = plant_.mechanisms[axis.mechanism];
  const auto loop = static_cast<std::size_t>(axis.loop);
  const JointPose& pose = mechanism.loop_pose(loop);
  const AxisDirection along = axis_direction(*axis.spec, pose);
  const PathMotion line = line_at(mechanism.loop_ends(loop), plant_.bodies, pose.pb, along.w, along.v);
  rows.rows.push_back({.line = line, .without_loops = mechanism.free_response(line, plant_.bodies)});
}

// The offset is known in connect_responses() only.
RowEnd& Bounded::add_mechanism_end(RowBlock& block, int mechanism) {
  RowEnd& end = block.ends[block.end_count++];
  end.free = false;
  end.mechanism = static_cast<std::size_t>(mechanism);
  end.first = rows_of(end.mechanism).rows.size();
  return end;
}

void Bounded::connect_mechanism(RowBlock& block, int a, const Reach* at_a, int b, const Reach* at_b) {
  const Place& any = plant_.places[static_cast<std::size_t>(at_a != nullptr ? a : b)];
  add_mechanism_end(block, any.mechanism);
  for (std::size_t row = 0; row < block.dim; ++row) {
    PathMotion line;
    if (at_a != nullptr) {
      line.node_a = plant_.places[static_cast<std::size_t>(a)].node;
      line.angular_a = angular((*at_a)[row]);
      line.linear_a = linear((*at_a)[row]);
    }
    if (at_b != nullptr) {
      line.node_b = plant_.places[static_cast<std::size_t>(b)].node;
      line.angular_b = angular((*at_b)[row]);
      line.linear_b = linear((*at_b)[row]);
    }
    rows_of(static_cast<std::size_t>(any.mechanism)).rows.push_back({.line = line});
  }
}

// measure_ahead() asks for the marks. A limited step has rows on bodies instead of mechanisms.
void Bounded::mark_bound() {
  for (const std::size_t m : mechanisms()) plant_.mechanism_bound[m] = !rows_of(m).rows.empty();
  if (!apart_) return;
  for (const std::size_t body : slotted_)
    if (const int m = plant_.places[body].mechanism; m >= 0)
      plant_.mechanism_bound[static_cast<std::size_t>(m)] = true;
}

// First the bodies without joints, then the mechanisms; likewise W of each mechanism.
void Bounded::lay_out() {
  std::size_t velocities = 6 * slotted_.size(), responses = 0;
  for (const std::size_t m : mechanisms()) {
    // Each row needs an answer of the mechanism (find_response), which is looked at from each row.
    MechanismRows& rows = rows_of(m);
    work_.take(rows.rows.size() * (plant_.mechanisms[m].units() + rows.rows.size()));
    rows.offset = velocities;
    rows.response = responses;
    velocities += rows.rows.size();
    responses += rows.rows.size() * rows.rows.size();
  }
  velocities_.resize(velocities);
  responses_.resize(responses);
}

void Bounded::connect_responses() {
  for (RowBlock& block : blocks_) {
    for (std::size_t e = 0; e < block.end_count; ++e) {
      RowEnd& end = block.ends[e];
      if (end.free) continue;
      const MechanismRows& rows = rows_of(end.mechanism);
      end.size = rows.rows.size();
      end.response = rows.response;
      end.offset = rows.offset;
    }
  }
  for (const std::size_t m : mechanisms()) find_response(m, responses_.data() + rows_of(m).response);
  // Stops and laws measure their response by that of the axis alone.
  for (std::size_t k = 0; k < blocks_.size(); ++k) {
    if (owners_[k].of != Of::kStop && owners_[k].of != Of::kLaw) continue;
    const RowEnd& end = blocks_[k].ends[0];
    blocks_[k].free_response = rows_of(end.mechanism).rows[end.first].without_loops;
  }
}

double Bounded::rate_in_answer(std::size_t m, const MechanismRow& row) const {
  const Mechanism& mechanism = plant_.mechanisms[m];
  return row.axis != nullptr ? mechanism.tree().axis_rate(static_cast<std::size_t>(row.axis->node))
                             : mechanism.rate(row.line);
}

void Bounded::find_response(std::size_t m, double* W) {
  if (rows_of(m).rows.empty()) return;
  Mechanism& mechanism = plant_.mechanisms[m];
  mechanism.factor(plant_.bodies);
  std::vector<MechanismRow>& rows = rows_of(m).rows;
  if (!mechanism.holds_responses_cheaply(rows.size()) || !trace_rows(m))
    return find_response_row_by_row(m, W);
  mechanism.tree().find_response(W);
  if (mechanism.loop_count() == 0) return;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i].axis != nullptr) rows[i].without_loops = W[i * rows.size() + i];
  mechanism.hold_responses(rows.size(), W);
}

// The three rows of a contact act on the same bodies, so they are followed together.
bool Bounded::trace_rows(std::size_t m) {
  Tree& tree = plant_.mechanisms[m].tree();
  const std::vector<MechanismRow>& rows = rows_of(m).rows;
  tree.begin_traces(rows.size());
  for (std::size_t i = 0, count = 0; i < rows.size(); i += count) {
    std::array<TreePush, Tree::kMostTogether> a, b;
    const MechanismRow& first = rows[i];
    if (first.axis != nullptr) {
      count = 1;
      a[0] = tree.push_on_axis(static_cast<std::size_t>(first.axis->node));
    } else {
      for (count = 0; count < Tree::kMostTogether && i + count < rows.size(); ++count) {
        const MechanismRow& row = rows[i + count];
        const PathMotion& line = row.line;
        if (row.axis != nullptr || line.node_a != first.line.node_a || line.node_b != first.line.node_b)
          break;
        a[count] = tree.push_at(line.node_a, line.angular_a, line.linear_a);
        b[count] = tree.push_at(line.node_b, line.angular_b, line.linear_b);
      }
    }
    tree.trace(std::span(a).first(count), std::span(b).first(count));
    if (tree.step_count() > kMostWaySteps * tree.size()) return false;
  }
  return true;
}

// A unit impulse on each of the rows, answered by the mechanism.
void Bounded::find_response_row_by_row(std::size_t m, double* W) {
  MechanismRows& rows = rows_of(m);
  Mechanism& mechanism = plant_.mechanisms[m];
  const std::size_t n = rows.rows.size();
  for (std::size_t i = 0; i < n; ++i) {
    mechanism.clear();
    MechanismRow& row = rows.rows[i];
    if (row.axis != nullptr)
      mechanism.tree().push_axis(static_cast<std::size_t>(row.axis->node), 1.0);
    else
      mechanism.push(row.line, 1.0);
    // Without the loops' answer: the tree's alone.
    if (mechanism.loop_count() > 0 && row.axis != nullptr) {
      mechanism.tree().solve();
      row.without_loops = rate_in_answer(m, row);
    }
    mechanism.solve();
    for (std::size_t j = 0; j < n; ++j) W[i * n + j] = rate_in_answer(m, rows.rows[j]);
  }
}

}  // namespace visum::dynamics::impulse

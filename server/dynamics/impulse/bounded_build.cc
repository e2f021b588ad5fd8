#include <algorithm>
#include <cmath>

#include "server/dynamics/impulse/bounded.h"

namespace visum::dynamics::impulse {

Bounded::Bounded(Plant& plant)
    : plant_(plant), of_mechanism_(plant.mechanisms.size()), slot_(plant.bodies.size(), kNone) {}

void Bounded::reset(Moment moment, double h) {
  moment_ = moment;
  h_ = h;
  rows_.clear();
  owners_.clear();
  for (MechanismRows& rows : of_mechanism_) rows.rows.clear();
  for (const std::size_t body : slotted_) slot_[body] = kNone;
  slotted_.clear();
}

void Bounded::build(Moment moment, double h) {
  reset(moment, h);
  if (moment == kAhead) rests_ = true;
  for (std::size_t i = 0; i < plant_.touches.size(); ++i) add_touch(i);
  for (std::size_t i = 0; i < plant_.axes.size(); ++i) add_axis(i);
  if (moment == kAhead)
    for (std::size_t i = 0; i < plant_.springs.size(); ++i) add_spring(i);
  finish();
}

RowBlock& Bounded::add_block(Owner owner, std::size_t dim) {
  owners_.push_back(owner);
  RowBlock& block = rows_.blocks.emplace_back();
  block.dim = dim;
  return block;
}

void Bounded::add_touch(std::size_t index) {
  const Touch& touch = plant_.touches[index];
  if (touch.asleep) return;
  RowBlock& block = add_block({Of::kTouch, index}, 3);
  block.kind = RowBlock::Kind::kContact;
  block.gives = moment_ != kHit;
  if (moment_ == kAfter) block.rest = touch.impulse[kAhead][0];
  for (int i = 0; i < 3; ++i) block.lambda[static_cast<std::size_t>(i)] = touch.impulse[moment_][i];
  Reach a{touch.a, {}, {}}, b{touch.b, {}, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d direction = touch.frame.col(static_cast<int>(i));
    a.angular[i] = touch.ra.cross(direction);
    a.linear[i] = direction;
    b.angular[i] = -touch.rb.cross(direction);
    b.linear[i] = -direction;
  }
  for (const int body : {touch.a, touch.b})
    if (body >= 0)
      block.free_response += plant_.bodies.constants[static_cast<std::size_t>(body)].inverse_mass;
  connect_bodies(block, a, b);
  if (is_held_from_turning(touch)) add_twist(index);
}

// Right after its contact.
void Bounded::add_twist(std::size_t index) {
  const Touch& touch = plant_.touches[index];
  RowBlock& block = add_block({Of::kTwist, index}, 3);
  block.kind = RowBlock::Kind::kTwist;
  block.contact = rows_.blocks.size() - 2;
  block.friction = touch.rolling_friction;
  block.torsion = touch.torsional_friction;
  for (int i = 0; i < 3; ++i) block.lambda[static_cast<std::size_t>(i)] = touch.twist[moment_][i];
  Reach a{touch.a, {}, {}}, b{touch.b, {}, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    a.angular[i] = touch.frame.col(static_cast<int>(i));
    b.angular[i] = -a.angular[i];
    a.linear[i] = b.linear[i] = Vector3d::Zero();
  }
  for (const int body : {touch.a, touch.b})
    if (body >= 0)
      block.free_response +=
          plant_.bodies.constants[static_cast<std::size_t>(body)].inverse_moments.sum() / 3.0;
  connect_bodies(block, a, b);
}

void Bounded::add_axis(std::size_t index) {
  const Axis& axis = plant_.axes[index];
  if (plant_.mechanism_asleep[axis.mechanism]) return;
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

// At the end only a stop that has pushed, or that the look-ahead has reached.
void Bounded::add_stop(std::size_t index, std::size_t side) {
  const Axis& axis = plant_.axes[index];
  const double sign = side == 0 ? -1.0 : 1.0;
  if (moment_ == kHit && !axis.hits[side]) return;
  if (moment_ == kAfter && axis.stopped[side][kAhead] == 0.0 && room(axis, side) > h_ * sign * axis.mean_rate)
    return;
  connect_axis(add_block({Of::kStop, index, side}, 1), axis);
}

void Bounded::add_spring(std::size_t index) {
  const JointSpec& spec = plant_.springs[index].spec;
  const auto& [w, v, pa, pb] = plant_.springs[index].pull;
  if (!plant_.springs[index].acts) return;
  RowBlock& block = add_block({Of::kSpring, index}, 1);
  Reach a{spec.a, {}, {}}, b{spec.b, {}, {}};
  if (spec.a >= 0) a.angular[0] = -w - (pa - plant_.bodies.x[static_cast<std::size_t>(spec.a)]).cross(v);
  a.linear[0] = -v;
  b.angular[0] = w + (pb - plant_.bodies.x[static_cast<std::size_t>(spec.b)]).cross(v);
  b.linear[0] = v;
  connect_bodies(block, a, b);
}

void Bounded::connect_axis(RowBlock& block, const Axis& axis) {
  MechanismRows& rows = of_mechanism_[axis.mechanism];
  add_mechanism_end(block, static_cast<int>(axis.mechanism));
  if (axis.node >= 0) {
    rows.rows.push_back({&axis, {}});
    return;
  }
  const Mechanism& mechanism = plant_.mechanisms[axis.mechanism];
  const JointSpec& joint = plant_.spec(axis);
  const JointPose& pose = mechanism.loop_pose(static_cast<std::size_t>(axis.loop));
  const AxisDirection along = axis_direction(joint, pose);
  rows.rows.push_back(
      {nullptr, line_at(mechanism, plant_.bodies, joint.a, joint.b, pose.pb, along.w, along.v)});
}

void Bounded::connect_bodies(RowBlock& block, const Reach& a, const Reach& b) {
  const auto mechanism = [&](const Reach& reach) {
    return reach.body < 0 ? -1 : plant_.places[static_cast<std::size_t>(reach.body)].mechanism;
  };
  if (mechanism(a) >= 0 && mechanism(a) == mechanism(b)) return connect_mechanism(block, &a, &b);
  for (const Reach* reach : {&a, &b}) {
    if (reach->body < 0) continue;
    if (mechanism(*reach) < 0)
      connect_free(block, *reach);
    else
      connect_mechanism(block, reach == &a ? reach : nullptr, reach == &b ? reach : nullptr);
  }
}

void Bounded::connect_free(RowBlock& block, const Reach& reach) {
  const auto body = static_cast<std::size_t>(reach.body);
  if (slot_[body] == kNone) {
    slot_[body] = 6 * slotted_.size();
    slotted_.push_back(body);
    FreeBody& free = rows_.bodies.emplace_back();
    free.mass = plant_.bodies.constants[body].mass;
    const Matrix3d& inertia = plant_.bodies.inertia[body];
    std::copy(inertia.data(), inertia.data() + 9, free.inertia.begin());
  }
  RowEnd& end = block.ends[block.end_count++];
  end.offset = slot_[body];
  for (std::size_t row = 0; row < block.dim; ++row) {
    const Vector3d turned = plant_.bodies.inverse_inertia[body] * reach.angular[row];
    const Vector3d moved = plant_.bodies.constants[body].inverse_mass * reach.linear[row];
    for (int k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      end.J[row][i] = reach.angular[row][k];
      end.J[row][i + 3] = reach.linear[row][k];
      end.MJ[row][i] = turned[k];
      end.MJ[row][i + 3] = moved[k];
    }
  }
}

// Its offset is known in finish().
RowEnd& Bounded::add_mechanism_end(RowBlock& block, int mechanism) {
  RowEnd& end = block.ends[block.end_count++];
  end.free = false;
  end.mechanism = static_cast<std::size_t>(mechanism);
  end.first = of_mechanism_[end.mechanism].rows.size();
  return end;
}

void Bounded::connect_mechanism(RowBlock& block, const Reach* a, const Reach* b) {
  const Place& any = plant_.places[static_cast<std::size_t>((a != nullptr ? a : b)->body)];
  add_mechanism_end(block, any.mechanism);
  for (std::size_t row = 0; row < block.dim; ++row) {
    Line line;
    if (a != nullptr) {
      line.node_a = plant_.places[static_cast<std::size_t>(a->body)].node;
      line.angular_a = a->angular[row];
      line.linear_a = a->linear[row];
    }
    if (b != nullptr) {
      line.node_b = plant_.places[static_cast<std::size_t>(b->body)].node;
      line.angular_b = b->angular[row];
      line.linear_b = b->linear[row];
    }
    of_mechanism_[static_cast<std::size_t>(any.mechanism)].rows.push_back({nullptr, line});
  }
}

void Bounded::finish() {
  std::size_t offset = 6 * slotted_.size(), response = 0;
  for (MechanismRows& rows : of_mechanism_) {
    rows.offset = offset;
    rows.response = response;
    offset += rows.rows.size();
    response += rows.rows.size() * rows.rows.size();
  }
  rows_.velocities.resize(offset);
  rows_.responses.resize(response);
  for (RowBlock& block : rows_.blocks) {
    for (std::size_t e = 0; e < block.end_count; ++e) {
      RowEnd& end = block.ends[e];
      if (end.free) continue;
      const MechanismRows& rows = of_mechanism_[end.mechanism];
      end.size = rows.rows.size();
      end.response = rows.response;
      end.offset = rows.offset;
    }
  }
  for (std::size_t m = 0; m < of_mechanism_.size(); ++m) find_response(m);
  rows_.prepare();
  before_.resize(rows_.blocks.size());
}

// W, a row for each unit impulse.
void Bounded::find_response(std::size_t m) {
  const MechanismRows& rows = of_mechanism_[m];
  Mechanism& mechanism = plant_.mechanisms[m];
  const std::size_t n = rows.rows.size();
  if (n > 0) mechanism.factor(plant_.bodies);
  for (std::size_t i = 0; i < n; ++i) {
    mechanism.clear();
    const MechanismRow& row = rows.rows[i];
    if (row.axis != nullptr)
      mechanism.tree().push_axis(static_cast<std::size_t>(row.axis->node), 1.0);
    else
      mechanism.push(row.line, 1.0);
    mechanism.solve();
    for (std::size_t j = 0; j < n; ++j) {
      const MechanismRow& other = rows.rows[j];
      rows_.responses[rows.response + i * n + j] =
          other.axis != nullptr ? mechanism.tree().axis_rate(static_cast<std::size_t>(other.axis->node))
                                : mechanism.rate(other.line);
    }
  }
}

}  // namespace visum::dynamics::impulse

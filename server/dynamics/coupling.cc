#include "server/dynamics/coupling.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace visum::dynamics {
namespace {

constexpr double kLayerM = 1e-5;      // a contact rests at this depth
constexpr double kPushShare = 0.1;    // of an overlap beyond it, in a tick
constexpr double kMostPush = 0.5;     // m/s
constexpr double kFallTicks = 2.0;    // a slower hit than a fall of this many ticks does not bounce
constexpr double kMiss = 1e-6;        // m/s: the impulses agree
constexpr double kMostMiss = 1e-4;    // m/s: they nearly agree; beyond, the tick warns
constexpr int kManyPasses = 8;        // after these, nearly is enough
constexpr double kAstray = 10.0;      // times the least miss so far
constexpr double kLeastShare = 1e-8;  // of the largest of the directions looked back at: less is rounding
constexpr int kSweeps = 40;           // over the contacts, for one change
constexpr double kSwept = 1e-12;      // share of the largest impulse: nothing changes any more

// An impulse as it is kept from tick to tick.
struct Record {
  std::int32_t shape_a, shape_b, feature, unused;
  double impulse[3];  // in W
};

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& r) {
  Eigen::Matrix3d m;
  m << 0.0, -r.z(), r.y(), r.z(), 0.0, -r.x(), -r.y(), r.x(), 0.0;
  return m;
}

Eigen::Vector3d velocity_at(const world::BodyState& body, const Eigen::Vector3d& lever) {
  return body.v_WC + body.w_WB.cross(lever);
}

// The nearest impulse that pushes and rubs within its cone.
Eigen::Vector3d in_cone(Eigen::Vector3d p, double friction) {
  p[0] = std::max(0.0, p[0]);
  const double most = friction * p[0], rub = p.tail<2>().norm();
  if (rub > most) p.tail<2>() *= rub > 0.0 ? most / rub : 0.0;
  return p;
}

}  // namespace

StepResult Coupling::step_each(std::span<const std::unique_ptr<Engine>> engines, const StepInput& input,
                               world::WorldState& state,
                               const std::function<void(std::uint32_t)>& entering) const {
  StepResult all;
  for (std::uint32_t i = 0; i < engines.size(); ++i) {
    if (entering) entering(i);
    StepResult result = engines[i]->step(input, state);
    if (!result.ok) return result;
    all.warned = all.warned || result.warned;
    all.limited = all.limited || result.limited;
    all.fell_short.insert(all.fell_short.end(), result.fell_short.begin(), result.fell_short.end());
    all.work += result.work;
    all.standing += result.standing;
  }
  return all;
}

StepResult Coupling::step(std::span<const std::unique_ptr<Engine>> engines, const StepInput& input,
                          world::WorldState& state, const std::function<void(std::uint32_t)>& entering) {
  rows_.clear();
  if (engines.size() > 1) find_rows(engines, input, state);
  if (rows_.empty()) {
    state.coupling.clear();
    return step_each(engines, input, state, entering);
  }
  start_ = state;
  known_ = 0;
  read(state, input.contacts);
  double least = std::numeric_limits<double>::infinity(), miss = 0.0;
  StepResult result;
  for (int k = 0; k < kMostPasses; ++k) {
    result = pass(engines, input, state, entering);
    if (!result.ok) return result;
    miss = find_change(state);
    if (!(miss > least)) {
      least = miss;
      best_ = p_;
      best_change_ = change_;
      best_missed_ = missed_;
    }
    if (miss <= kMiss || (k >= kManyPasses && least <= kMostMiss) || k + 1 == kMostPasses) break;
    // Where an extrapolation leads astray, the next pass begins again from the best one.
    if (miss > kAstray * least) {
      p_ = best_;
      change_ = best_change_ *= 0.5;
      missed_ = best_missed_ *= 0.5;
      known_ = 0;
    }
    extrapolate();
  }
  if (miss > least) {
    p_ = best_;
    result = pass(engines, input, state, entering);
    if (!result.ok) return result;
  }
  result.warned = result.warned || !(least <= kMostMiss);
  report(input);
  write(state, input.contacts);
  return result;
}

void Coupling::find_rows(std::span<const std::unique_ptr<Engine>> engines, const StepInput& input,
                         const world::WorldState& state) {
  inner_.clear();
  inner_of_.clear();
  inverse_inertia_.resize(model_.bodies.size());
  for (std::size_t i = 0; i < input.contacts.size(); ++i) {
    const collision::Contact& contact = input.contacts[i];
    const world::Body &a = model_.bodies[contact.body_a.index()], &b = model_.bodies[contact.body_b.index()];
    const auto may_repeat = [&](const world::Body& body) {
      return engines[static_cast<std::size_t>(body.engine)]->may_repeat();
    };
    if (a.fixed || b.fixed || a.kinematic || b.kinematic || a.engine == b.engine || !may_repeat(a) ||
        !may_repeat(b)) {
      inner_.push_back(contact);
      inner_of_.push_back(i);
      continue;
    }
    for (const world::BodyId id : {contact.body_a, contact.body_b}) {
      const Eigen::Matrix3d R = state.bodies[id.index()].q_WB.toRotationMatrix();
      inverse_inertia_[id.index()] = R * model_.bodies[id.index()].inertia_C.inverse() * R.transpose();
    }
    rows_.push_back(make_row(i, contact, state, input.tick_s));
  }
}

Coupling::Row Coupling::make_row(std::size_t index, const collision::Contact& contact,
                                 const world::WorldState& state, double tick_s) const {
  Row row;
  row.contact = index;
  row.a = contact.body_a.index();
  row.b = contact.body_b.index();
  const Eigen::Vector3d& n = contact.normal_W;
  const Eigen::Vector3d t = n.unitOrthogonal();
  row.frame << n, t, n.cross(t);
  row.ra = contact.p_W - state.bodies[row.a].p_WC;
  row.rb = contact.p_W - state.bodies[row.b].p_WC;
  Eigen::Matrix3d response =
      (1.0 / model_.bodies[row.a].mass_kg + 1.0 / model_.bodies[row.b].mass_kg) * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d ra = cross_matrix(row.ra), rb = cross_matrix(row.rb);
  response -= ra * inverse_inertia_[row.a] * ra + rb * inverse_inertia_[row.b] * rb;
  row.response = row.frame.transpose() * response * row.frame;
  row.friction = contact.friction;
  // Shapes may come as near as the layer. Deeper ones are pushed out, and hits bounce.
  const double beyond = contact.depth - kLayerM;
  row.target = std::min((beyond < 0.0 ? 1.0 : kPushShare) * beyond / tick_s, kMostPush);
  const double speed =
      -n.dot(velocity_at(state.bodies[row.a], row.ra) - velocity_at(state.bodies[row.b], row.rb));
  if (speed > kFallTicks * tick_s * model_.gravity.norm())
    row.target = std::max(row.target, contact.restitution * speed);
  return row;
}

StepResult Coupling::pass(std::span<const std::unique_ptr<Engine>> engines, const StepInput& input,
                          world::WorldState& state, const std::function<void(std::uint32_t)>& entering) {
  state = start_;
  wrenches_.assign(input.wrenches.begin(), input.wrenches.end());
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[i];
    const Eigen::Vector3d force = row.frame * p_.segment<3>(3 * static_cast<Eigen::Index>(i)) / input.tick_s;
    wrenches_.push_back({{static_cast<std::int32_t>(row.a)}, force, row.ra.cross(force)});
    wrenches_.push_back({{static_cast<std::int32_t>(row.b)}, -force, -row.rb.cross(force)});
  }
  const StepInput inner{input.tick_s, inner_, input.drives, wrenches_};
  return step_each(engines, inner, state, entering);
}

double Coupling::find_change(const world::WorldState& state) {
  const Eigen::VectorXd before = p_;
  dv_.assign(model_.bodies.size(), Eigen::Vector3d::Zero());
  dw_.assign(model_.bodies.size(), Eigen::Vector3d::Zero());
  const double tiny = kSwept * std::max(1e-9, p_.cwiseAbs().maxCoeff());
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double largest = 0.0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Row& row = rows_[i];
      auto p = p_.segment<3>(3 * static_cast<Eigen::Index>(i));
      const Eigen::Vector3d u =
          row.frame.transpose() *
          (velocity_at(state.bodies[row.a], row.ra) - velocity_at(state.bodies[row.b], row.rb) + dv_[row.a] +
           dw_[row.a].cross(row.ra) - dv_[row.b] - dw_[row.b].cross(row.rb));
      Eigen::Vector3d next = p;
      next[0] -= (u[0] - row.target) / row.response(0, 0);
      next.tail<2>() -= u.tail<2>() / row.response.bottomRightCorner<2, 2>().trace();
      next = in_cone(next, row.friction);
      const Eigen::Vector3d given = row.frame * (next - p);
      p = next;
      largest = std::max(largest, given.norm());
      dv_[row.a] += given / model_.bodies[row.a].mass_kg;
      dw_[row.a] += inverse_inertia_[row.a] * row.ra.cross(given);
      dv_[row.b] -= given / model_.bodies[row.b].mass_kg;
      dw_[row.b] -= inverse_inertia_[row.b] * row.rb.cross(given);
    }
    if (largest <= tiny) break;
  }
  change_ = p_ - before;
  p_ = before;
  double miss = 0.0;
  missed_.resize(p_.size());
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[i];
    const Eigen::Vector3d u = dv_[row.a] + dw_[row.a].cross(row.ra) - dv_[row.b] - dw_[row.b].cross(row.rb);
    missed_.segment<3>(3 * static_cast<Eigen::Index>(i)) = u;
    if (!(u.norm() <= miss)) miss = u.norm();
  }
  return miss;
}

void Coupling::extrapolate() {
  Eigen::VectorXd next = p_ + change_;
  const Eigen::Index known = std::min<Eigen::Index>(known_, kMemory), size = p_.size();
  if (known > 0) {
    Eigen::MatrixXd of_next(size, known), of_missed(size, known);
    for (Eigen::Index k = 0; k < known; ++k) {
      const std::size_t past = static_cast<std::size_t>(known_ - 1 - k) % kMemory;
      of_next.col(k) = next - past_next_[past];
      of_missed.col(k) = missed_ - past_missed_[past];
    }
    Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(of_missed);
    qr.setThreshold(kLeastShare);
    const Eigen::VectorXd share = qr.solve(missed_);
    past_next_[static_cast<std::size_t>(known_) % kMemory] = next;
    if (share.allFinite()) next -= of_next * share;
  } else {
    past_next_[0] = next;
  }
  past_missed_[static_cast<std::size_t>(known_) % kMemory] = missed_;
  ++known_;
  p_ = next;
  hold_in_cones();
}

void Coupling::hold_in_cones() {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    auto p = p_.segment<3>(3 * static_cast<Eigen::Index>(i));
    p = in_cone(p, rows_[i].friction);
  }
}

void Coupling::report(const StepInput& input) const {
  for (std::size_t i = 0; i < inner_.size(); ++i) input.contacts[inner_of_[i]] = inner_[i];
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Eigen::Vector3d p = p_.segment<3>(3 * static_cast<Eigen::Index>(i));
    collision::Contact& contact = input.contacts[rows_[i].contact];
    contact.normal_force_n = p[0] / input.tick_s;
    contact.force_on_a_W = rows_[i].frame * p / input.tick_s;
    contact.torque_on_a_W.setZero();
  }
}

// Contacts are sorted, and so are the records.
void Coupling::read(const world::WorldState& state, std::span<const collision::Contact> contacts) {
  p_.setZero(3 * static_cast<Eigen::Index>(rows_.size()));
  if (state.coupling.size() % sizeof(Record) != 0) return;
  std::size_t at = 0;
  const auto record = [&](std::size_t i) {
    Record one;
    std::memcpy(&one, state.coupling.data() + i * sizeof(Record), sizeof(Record));
    return one;
  };
  const std::size_t count = state.coupling.size() / sizeof(Record);
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const collision::Contact& contact = contacts[rows_[i].contact];
    const std::array key{contact.shape_a.value, contact.shape_b.value, contact.feature};
    while (at < count) {
      const Record one = record(at);
      const std::array known{one.shape_a, one.shape_b, one.feature};
      if (known > key) break;
      ++at;
      if (known < key) continue;
      const Eigen::Vector3d impulse = Eigen::Map<const Eigen::Vector3d>(one.impulse);
      if (impulse.allFinite())
        p_.segment<3>(3 * static_cast<Eigen::Index>(i)) = rows_[i].frame.transpose() * impulse;
      break;
    }
  }
  hold_in_cones();
}

void Coupling::write(world::WorldState& state, std::span<const collision::Contact> contacts) const {
  state.coupling.resize(rows_.size() * sizeof(Record));
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const collision::Contact& contact = contacts[rows_[i].contact];
    const Eigen::Vector3d p = rows_[i].frame * p_.segment<3>(3 * static_cast<Eigen::Index>(i));
    const Record one{contact.shape_a.value, contact.shape_b.value, contact.feature, 0, {p.x(), p.y(), p.z()}};
    std::memcpy(state.coupling.data() + i * sizeof(Record), &one, sizeof(Record));
  }
}

}  // namespace visum::dynamics

#include "server/dynamics/impulse/corrector.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace visum::dynamics::impulse {
namespace {

// Largest component of two vectors.
double largest_of(const Vector3d& a, const Vector3d& b) {
  return std::max(a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff());
}

}  // namespace

Corrector::Corrector(Plant& plant)
    : plant_(plant), joints_(plant.mechanisms.size()), is_ahead_(plant.bodies.size(), 0) {
  for (std::size_t m = 0; m < joints_.size(); ++m) {
    const Mechanism& mechanism = plant.mechanisms[m];
    for (std::size_t i = 0; i < mechanism.size(); ++i)
      if (mechanism.carrying(i) != nullptr) add_joint(m, *mechanism.carrying(i), mechanism.pose(i));
    for (std::size_t i = 0; i < mechanism.loop_count(); ++i)
      add_joint(m, mechanism.loop(i), mechanism.loop_pose(i));
  }
}

void Corrector::add_joint(std::size_t m, const JointSpec& spec, const JointPose& pose) {
  Joint& joint = joints_[m].emplace_back();
  joint.spec = &spec;
  joint.pose = &pose;
  // A joint knows its axis, if it has one.
  for (std::size_t i = plant_.first_axis[m]; i < plant_.first_axis[m + 1]; ++i)
    if (plant_.axes[i].joint == spec.id) joint.own_axis = i;
}

// The axis of a joint is a row of its own while its law is within its limit.
void Corrector::prepare(std::size_t m, double h) {
  for (Joint& joint : joints_[m]) {
    const bool gives = joint.own_axis != kNoAxis && is_in_tree(plant_.axes[joint.own_axis], kAfter);
    joint.axis = gives ? &plant_.axes[joint.own_axis] : nullptr;
    add_rows(joint);
    invert(joint, h);
  }
}

void Corrector::add_rows(Joint& joint) {
  const JointPose& pose = *joint.pose;
  const Bodies& bodies = plant_.bodies;
  joint.rb = pose.pb - bodies.x[static_cast<std::size_t>(joint.spec->b)];
  if (joint.spec->a >= 0) joint.ra = pose.pb - bodies.x[static_cast<std::size_t>(joint.spec->a)];
  // One row for each direction that the joint holds.
  const Held held = held_directions(*joint.spec, pose);
  joint.count = static_cast<std::size_t>(held.count);
  for (std::size_t k = 0; k < joint.count; ++k) {
    joint.w[k] = held.w[k];
    joint.v[k] = held.v[k];
  }
  // The law of the axis is the last row.
  if (joint.axis == nullptr) return;
  const AxisDirection axis = axis_direction(*joint.spec, pose);
  joint.w[joint.count] = axis.w;
  joint.v[joint.count] = axis.v;
  ++joint.count;
}

// K is 6 x 6; rows that do not exist get 1 on the diagonal.
void Corrector::invert(Joint& joint, double h) const {
  Eigen::Matrix<double, 6, 6> K = Eigen::Matrix<double, 6, 6>::Identity();
  const auto n = static_cast<int>(joint.count);
  K.topLeftCorner(n, n).setZero();
  // Adds one body: its response to an impulse on row k, seen by row l.
  const auto add = [&](int number, const Vector3d& r) {
    if (number < 0) return;
    const auto body = static_cast<std::size_t>(number);
    const double inverse_mass = plant_.bodies.constants[body].inverse_mass;
    std::array<Vector3d, 6> turn;
    for (std::size_t k = 0; k < joint.count; ++k) turn[k] = joint.w[k] + r.cross(joint.v[k]);
    for (std::size_t k = 0; k < joint.count; ++k) {
      const Vector3d turned = plant_.bodies.inverse_inertia[body] * turn[k];
      for (std::size_t l = 0; l < joint.count; ++l)
        K(static_cast<int>(l), static_cast<int>(k)) +=
            inverse_mass * joint.v[l].dot(joint.v[k]) + turn[l].dot(turned);
    }
  };
  add(joint.spec->a, joint.ra);
  add(joint.spec->b, joint.rb);
  // The drive gives way by its compliance.
  if (joint.axis != nullptr) K(n - 1, n - 1) += law_compliance(plant_, *joint.axis, kAfter, h);
  const Eigen::Matrix<double, 6, 6> inverse = K.llt().solve(Eigen::Matrix<double, 6, 6>::Identity());
  for (int k = 0; k < n; ++k)
    for (int l = 0; l < n; ++l)
      joint.inverse_K[static_cast<std::size_t>(k)][static_cast<std::size_t>(l)] = inverse(k, l);
}

double Corrector::largest_gap(std::size_t m) const {
  double largest = 0.0;
  for (const Joint& joint : joints_[m]) {
    const Gap gap = joint_gap(*joint.spec, *joint.pose);
    largest = larger(largest_of(gap.turn, gap.shift), largest);
  }
  return largest;
}

void Corrector::forget_look_ahead(std::size_t m) {
  const Mechanism& mechanism = plant_.mechanisms[m];
  for (std::size_t i = 0; i < mechanism.size(); ++i)
    is_ahead_[static_cast<std::size_t>(mechanism.body(i))] = 0;
}

void Corrector::look_ahead(int body, double h) {
  if (body < 0) return;
  const auto i = static_cast<std::size_t>(body);
  if (is_ahead_[i] != 0) return;
  plant_.bodies.look_ahead(plant_.bodies.block_of(i), h, plant_.model.gravity);
  is_ahead_[i] = 1;
}

void Corrector::look_ahead(std::size_t m, double h) {
  const Mechanism& mechanism = plant_.mechanisms[m];
  for (std::size_t i = 0; i < mechanism.size(); ++i) look_ahead(mechanism.body(i), h);
}

void Corrector::push(int number, const Vector3d& r, const Vector3d& T, const Vector3d& F, double sign) {
  if (number < 0) return;
  const auto i = static_cast<std::size_t>(number);
  Bodies& bodies = plant_.bodies;
  bodies.v[i] += (sign * bodies.constants[i].inverse_mass) * F;
  bodies.w[i] += sign * (bodies.inverse_inertia[i] * (T + r.cross(F)));
  is_ahead_[i] = 0;
}

// lambda = K^-1 errors; the last lambda is that of the law.
void Corrector::push(Joint& joint, const Errors& errors, Moment moment) {
  Vector3d T = Vector3d::Zero(), F = Vector3d::Zero();
  double lambda = 0.0;
  for (std::size_t k = 0; k < joint.count; ++k) {
    lambda = 0.0;
    for (std::size_t l = 0; l < joint.count; ++l) lambda += joint.inverse_K[k][l] * errors[l];
    T += lambda * joint.w[k];
    F += lambda * joint.v[k];
  }
  push(joint.spec->a, joint.ra, T, F, -1.0);
  push(joint.spec->b, joint.rb, T, F, 1.0);
  if (joint.axis != nullptr) take_law_impulse(*joint.axis, moment, lambda);
}

// Both bodies look ahead, the gap is projected on the rows, and an impulse closes it.
double Corrector::close_gap(Joint& joint, double h, double d_max, const world::JointState& last) {
  look_ahead(joint.spec->a, h);
  look_ahead(joint.spec->b, h);
  const JointPose ahead = pose_ahead(*joint.spec, plant_.bodies, last, h);
  const Gap gap = joint_gap(*joint.spec, ahead);
  double largest = largest_of(gap.turn, gap.shift);
  Errors errors{};
  for (std::size_t k = 0; k < joint.count; ++k)
    errors[k] = (joint.w[k].dot(gap.turn) + joint.v[k].dot(gap.shift)) / h;
  if (joint.axis != nullptr) {
    measure_ahead(plant_, *joint.axis, ahead, h);
    const double missing = missing_rate(plant_, *joint.axis, kAhead, h);
    errors[joint.count - 1] = missing;
    largest = std::max(largest, h * std::abs(missing));
  }
  if (!(largest <= d_max)) push(joint, errors, kAhead);
  return largest;
}

Vector3d Corrector::velocity_at(int number, const Vector3d& r) const {
  const auto i = static_cast<std::size_t>(number);
  return plant_.bodies.v[i] + plant_.bodies.w[i].cross(r);
}

// The relative velocity at P, projected on the rows, must be zero; the law has its own error.
double Corrector::match_velocity(Joint& joint, double h, double v_max) {
  const JointSpec& spec = *joint.spec;
  Vector3d w = plant_.bodies.w[static_cast<std::size_t>(spec.b)], v = velocity_at(spec.b, joint.rb);
  if (spec.a >= 0) {
    w -= plant_.bodies.w[static_cast<std::size_t>(spec.a)];
    v -= velocity_at(spec.a, joint.ra);
  }
  Errors errors{};
  for (std::size_t k = 0; k < joint.count; ++k) errors[k] = -joint.w[k].dot(w) - joint.v[k].dot(v);
  if (joint.axis != nullptr) errors[joint.count - 1] = missing_rate(plant_, *joint.axis, kAfter, h);
  double largest = 0.0;
  for (std::size_t k = 0; k < joint.count; ++k) largest = larger(std::abs(errors[k]), largest);
  if (!(largest <= v_max)) push(joint, errors, kAfter);
  return largest;
}

double Corrector::sweep_gaps(std::size_t m, double h, double d_max, const world::WorldState& state,
                             int sweep) {
  std::vector<Joint>& joints = joints_[m];
  double largest = 0.0;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    Joint& joint = joints[sweep % 2 == 0 ? i : joints.size() - 1 - i];
    const double gap = close_gap(joint, h, d_max, state.joints[joint.spec->id.index()]);
    if (gap <= largest) continue;
    largest = gap;
    worst_ = joint.spec;
    // A NaN ends the sweep: the joint is named, and the step fails.
    if (std::isnan(gap)) break;
  }
  return largest;
}

double Corrector::sweep_velocities(std::size_t m, double h, double v_max, int sweep) {
  std::vector<Joint>& joints = joints_[m];
  double largest = 0.0;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const double found = match_velocity(joints[sweep % 2 == 0 ? i : joints.size() - 1 - i], h, v_max);
    largest = larger(found, largest);
  }
  return largest;
}

}  // namespace visum::dynamics::impulse

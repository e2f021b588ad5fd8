#include "server/dynamics/impulse/bodies.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstring>

#include "server/dynamics/impulse/free_flight.h"
#include "server/dynamics/impulse/symmetric.h"

namespace visum::dynamics::impulse {
namespace {

constexpr double kSameMoment = 1e-12;  // relative: what rounding leaves of a symmetry

bool same(double a, double b) {
  return std::abs(a - b) <= kSameMoment * std::max(a, b);
}

void find_symmetry(BodyConstants& body) {
  const Vector3d& j = body.moments;
  const bool xy = same(j.x(), j.y()), yz = same(j.y(), j.z()), zx = same(j.z(), j.x());
  body.symmetry = xy && yz && zx ? Symmetry::kBall : xy || yz || zx ? Symmetry::kTop : Symmetry::kNone;
  body.axis = xy ? 2 : yz ? 0 : 1;
}

// A link whose axes are principal already keeps them.
void find_principal_axes(const Matrix3d& inertia, BodyConstants& body) {
  Matrix3d off = inertia;
  off.diagonal().setZero();
  body.q_BP = Quaterniond::Identity();
  body.aligned = off.cwiseAbs().maxCoeff() <= kSameMoment * inertia.cwiseAbs().maxCoeff();
  body.moments = inertia.diagonal();
  if (body.aligned) return;
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(inertia);
  Matrix3d axes = solver.eigenvectors();
  if (axes.determinant() < 0.0) axes.col(2) *= -1.0;
  body.moments = solver.eigenvalues();
  body.q_BP = Quaterniond(axes).normalized();
}

// m E + (n - m) a a^T: of a top with its axis a.
Matrix3d turned_top(double along, double across, const Vector3d& a) {
  const Vector3d s = (along - across) * a;
  return Symmetric3{s.x() * a.x() + across, s.y() * a.y() + across, s.z() * a.z() + across,
                    s.x() * a.y(),          s.y() * a.z(),          s.z() * a.x()}
      .full();
}

// R diag(moments) R^T.
Matrix3d turned(const BodyConstants& body, const Vector3d& moments, const Matrix3d& R) {
  switch (body.symmetry) {
    case Symmetry::kBall:
      return moments.asDiagonal();
    case Symmetry::kTop:
      return turned_top(moments[body.axis], moments[(body.axis + 1) % 3], R.col(body.axis));
    case Symmetry::kNone:
      break;
  }
  const Matrix3d s = R * moments.asDiagonal();
  const auto dot = [&](int i, int j) { return s(i, 0) * R(j, 0) + s(i, 1) * R(j, 1) + s(i, 2) * R(j, 2); };
  return Symmetric3{dot(0, 0), dot(1, 1), dot(2, 2), dot(0, 1), dot(1, 2), dot(2, 0)}.full();
}

}  // namespace

Bodies::Bodies(const world::WorldModel& model, std::int32_t engine_index)
    : numbers_(model.bodies.size(), -1) {
  for (std::size_t i = 0; i < model.bodies.size(); ++i) {
    const world::Body& from = model.bodies[i];
    if (from.fixed || from.engine != engine_index) continue;
    numbers_[i] = static_cast<int>(constants.size());
    BodyConstants body;
    body.id = {static_cast<std::int32_t>(i)};
    body.mass = from.mass_kg;
    body.inverse_mass = 1.0 / from.mass_kg;
    find_principal_axes(0.5 * (from.inertia_C + from.inertia_C.transpose()), body);
    body.inverse_moments = body.moments.cwiseInverse();
    find_symmetry(body);
    constants.push_back(body);
  }
  const std::size_t n = constants.size();
  is_oriented_.assign(n, 0);
  for (auto* list : {&x, &v, &w, &x1}) list->assign(n, Vector3d::Zero());
  for (auto* list : {&q, &q_WB, &q1}) list->assign(n, Quaterniond::Identity());
  for (auto* list : {&R, &R1, &inertia, &inverse_inertia}) list->assign(n, Matrix3d::Identity());
}

void Bodies::orient(std::size_t i) {
  q[i] = constants[i].aligned ? q_WB[i] : q_WB[i] * constants[i].q_BP;
  R[i] = q[i].toRotationMatrix();
  turn_inertia(i);
}

void Bodies::turn_inertia(std::size_t i) {
  const BodyConstants& body = constants[i];
  inertia[i] = turned(body, body.moments, R[i]);
  inverse_inertia[i] = turned(body, body.inverse_moments, R[i]);
}

void Bodies::load(const world::WorldState& state) {
  for (std::size_t i = 0; i < size(); ++i) {
    const world::BodyState& from = state.bodies[constants[i].id.index()];
    x[i] = from.p_WC;
    v[i] = from.v_WC;
    w[i] = from.w_WB;
    if (is_oriented_[i] &&
        std::memcmp(q_WB[i].coeffs().data(), from.q_WB.coeffs().data(), 4 * sizeof(double)) == 0)
      continue;
    q_WB[i] = from.q_WB;
    orient(i);
    is_oriented_[i] = true;
  }
}

void Bodies::keep(BodiesMotion& motion) const {
  motion.x = x;
  motion.v = v;
  motion.w = w;
  motion.q_WB = q_WB;
}

void Bodies::put_back(const BodiesMotion& motion) {
  x = motion.x;
  v = motion.v;
  w = motion.w;
  q_WB = motion.q_WB;
  for (std::size_t i = 0; i < size(); ++i) orient(i);
}

void Bodies::store(world::WorldState& state) const {
  for (std::size_t i = 0; i < size(); ++i)
    state.bodies[constants[i].id.index()] = {x[i], q_WB[i], v[i], w[i]};
}

void Bodies::look_ahead(std::size_t i, double h, const Vector3d& gravity) {
  x1[i] = x[i] + h * v[i] + (0.5 * h * h) * gravity;
  q1[i] = fly(constants[i], q[i], R[i], w[i], h);
  R1[i] = q1[i].toRotationMatrix();
}

void Bodies::nudge(std::size_t i, const Vector3d& shift, const Vector3d& turn) {
  x1[i] += shift;
  q1[i] = renormalised(Quaterniond(1.0, 0.5 * turn.x(), 0.5 * turn.y(), 0.5 * turn.z()) * q1[i]);
  R1[i] = q1[i].toRotationMatrix();
}

// What is kept from step to step is the link's orientation, so that a restored state goes on with the same
// bits: P's is made from it here as load() does.
void Bodies::commit(std::size_t i, double h, const Vector3d& gravity) {
  const Vector3d momentum = inertia[i] * w[i];
  x[i] = x1[i];
  v[i] += h * gravity;
  if (constants[i].aligned) {
    q_WB[i] = q[i] = q1[i];
    R[i] = R1[i];
    turn_inertia(i);
  } else {
    q_WB[i] = (q1[i] * constants[i].q_BP.conjugate()).normalized();
    orient(i);
  }
  w[i] = inverse_inertia[i] * momentum;
  // Where the moments differ, what the rounded inverse has lost is given back: the momentum is kept to
  // rounding.
  if (constants[i].symmetry == Symmetry::kNone) w[i] += inverse_inertia[i] * (momentum - inertia[i] * w[i]);
}

}  // namespace visum::dynamics::impulse

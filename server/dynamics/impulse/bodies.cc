#include "server/dynamics/impulse/bodies.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "server/dynamics/impulse/lanes/kernels.h"
#include "server/world/same_bits.h"

namespace visum::dynamics::impulse {
namespace {

using world::are_same_bits;

constexpr double kSameMoment = 1e-12;  // relative: differences below are rounding of a symmetric body

bool same(double a, double b) {
  return std::abs(a - b) <= kSameMoment * std::max(a, b);
}

// Two equal moments make a top, three a ball (a top about any axis).
void find_symmetry(BodyConstants& body) {
  const Vector3d& j = body.moments;
  const bool xy = same(j.x(), j.y()), yz = same(j.y(), j.z()), zx = same(j.z(), j.x());
  body.symmetry = xy && yz && zx ? Symmetry::kBall : xy || yz || zx ? Symmetry::kTop : Symmetry::kNone;
  body.axis = xy ? 2 : yz ? 0 : 1;
}

// Principal moments and axes. A link whose axes are principal already keeps them.
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

// Kernels treat bodies of one group alike: they move by the same formulas.
constexpr int kGroups = 8;
int group(const BodyConstants& body) {
  return 2 * (body.symmetry == Symmetry::kNone ? 3 : body.axis) + (body.aligned ? 0 : 1);
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
  // The entry behind the last body stands still, in place of everything that is not this engine's.
  for (auto* list : {&x, &v, &w, &x1}) list->assign(n + 1, Vector3d::Zero());
  for (auto* list : {&q, &q_WB, &q1}) list->assign(n + 1, Quaterniond::Identity());
  for (auto* list : {&R, &R1, &inertia, &inverse_inertia}) list->assign(n + 1, Matrix3d::Identity());
  const auto numbers = [](auto& list) { return reinterpret_cast<double*>(list.data()); };
  arrays_ = {numbers(x),    numbers(v),  numbers(w),       numbers(q),
             numbers(q_WB), numbers(R),  numbers(inertia), numbers(inverse_inertia),
             numbers(x1),   numbers(q1), numbers(R1)};
  for (std::size_t i = 0; i < n; ++i) {
    const int number = static_cast<int>(i);
    alone_.push_back(block({&number, 1}, {&number, 1}));
  }
}

// Constants of up to four bodies, lane by lane; the last body fills the remaining lanes.
BodyBlock Bodies::block(std::span<const int> numbers, std::span<const int> places) const {
  BodyBlock result;
  for (std::size_t lane = 0; lane < 4; ++lane) {
    const std::size_t k = std::min(lane, numbers.size() - 1);
    const BodyConstants& body = constants[static_cast<std::size_t>(numbers[k])];
    result.vector[lane] = 3L * numbers[k];
    result.quaternion[lane] = 4L * numbers[k];
    result.matrix[lane] = 9L * numbers[k];
    result.answer[lane] = places[k];
    result.top = body.symmetry != Symmetry::kNone;
    result.aligned = body.aligned;
    result.axis = body.axis;
    for (int i = 0; i < 3; ++i) {
      const int from = result.top ? (body.axis + 1 + i) % 3 : i;  // a top's own axis comes last
      result.moments[i][lane] = body.moments[from];
      result.inverse_moments[i][lane] = body.inverse_moments[from];
    }
    for (int i = 0; i < 4; ++i) result.q_BP[i][lane] = body.q_BP.coeffs()[i];
  }
  return result;
}

std::vector<BodyBlock> Bodies::blocks_of(std::span<const int> numbers) const {
  std::vector<BodyBlock> blocks;
  for (int wanted = 0; wanted < kGroups; ++wanted) {
    std::vector<int> members, places;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (group(constants[static_cast<std::size_t>(numbers[i])]) != wanted) continue;
      members.push_back(numbers[i]);
      places.push_back(static_cast<int>(i));
    }
    for (std::size_t i = 0; i < members.size(); i += 4) {
      const std::size_t count = std::min<std::size_t>(4, members.size() - i);
      blocks.push_back(block({&members[i], count}, {&places[i], count}));
    }
  }
  return blocks;
}

void Bodies::load(const world::WorldState& state) {
  const std::size_t count = size();
  for (std::size_t i = 0; i < count; ++i) {
    const world::BodyState& from = state.bodies[constants[i].id.index()];
    v[i] = from.v_WC;
    w[i] = from.w_WB;
    // Only a body that has moved makes placements() grow.
    if (!are_same_bits(x[i], from.p_WC)) {
      x[i] = from.p_WC;
      ++placements_;
    }
    if (is_oriented_[i] && are_same_bits(q_WB[i], from.q_WB)) continue;
    q_WB[i] = from.q_WB;
    kernels_.orient(arrays_, &alone_[i], 1);
    is_oriented_[i] = true;
    ++placements_;
  }
}

void Bodies::keep(BodiesMotion& motion) const {
  copy(x, motion.x);
  copy(v, motion.v);
  copy(w, motion.w);
  copy(q_WB, motion.q_WB);
}

void Bodies::put_back(const BodiesMotion& motion) {
  x = motion.x;
  v = motion.v;
  w = motion.w;
  q_WB = motion.q_WB;
  kernels_.orient(arrays_, alone_.data(), alone_.size());
  ++placements_;
}

void Bodies::put_to_rest(const BodiesMotion& motion, std::span<const std::size_t> numbers) {
  for (const std::size_t i : numbers) {
    x[i] = motion.x[i];
    q_WB[i] = motion.q_WB[i];
    v[i] = w[i] = Vector3d::Zero();
    kernels_.orient(arrays_, &alone_[i], 1);
    ++placements_;
  }
}

void Bodies::store(world::WorldState& state) const {
  const std::size_t count = size();
  for (std::size_t i = 0; i < count; ++i) {
    world::BodyState& to = state.bodies[constants[i].id.index()];
    to.p_WC = x[i];
    to.q_WB = q_WB[i];
    to.v_WC = v[i];
    to.w_WB = w[i];
  }
}

void Bodies::look_ahead(std::span<const BodyBlock> blocks, double h, const Vector3d& gravity) {
  kernels_.fly(arrays_, blocks.data(), blocks.size(), h, gravity.data());
}

// Only the link's orientation is kept from step to step. P's is computed from it, exactly as load() does, so
// a restored state goes on with the same bits.
bool Bodies::commit(std::span<const BodyBlock> blocks, double h, const Vector3d& gravity) {
  return kernels_.commit(arrays_, blocks.data(), blocks.size(), h, gravity.data());
}

}  // namespace visum::dynamics::impulse

// The bodies that the engine moves, as arrays by their number among them: constants, state at t, and where
// they will be at t+h. Frame P: axes of the principal moments of inertia, origin at the centre of mass.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstring>
#include <span>
#include <vector>

#include "server/dynamics/impulse/lanes/kernels.h"
#include "server/world/world_model.h"
#include "server/world/world_state.h"

namespace visum::dynamics::impulse {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

enum class Symmetry { kNone, kTop, kBall };  // of the principal moments: all differ; two or all are the same

struct BodyConstants {
  world::BodyId id;
  double mass = 0.0, inverse_mass = 0.0;
  Vector3d moments;  // principal, kg·m²
  Vector3d inverse_moments;
  Symmetry symmetry = Symmetry::kNone;
  int axis = 2;         // top: whose moment is the odd one
  Quaterniond q_BP;     // from P to the link's axes
  bool aligned = true;  // q_BP is the identity
};

// The state at t, as it is kept over a step that may fail.
struct BodiesMotion {
  std::vector<Vector3d> x, v, w;
  std::vector<Quaterniond> q_WB;
};

class Bodies {
 public:
  Bodies(const world::WorldModel& model, std::int32_t engine_index);
  Bodies(const Bodies&) = delete;
  Bodies& operator=(const Bodies&) = delete;

  std::size_t size() const { return constants.size(); }
  // A number for what is not ours: it stands, at the origin.
  int still() const { return static_cast<int>(size()); }
  int number(world::BodyId id) const { return id.valid() ? numbers_[id.index()] : -1; }  // -1: not ours

  void load(const world::WorldState& state);
  void store(world::WorldState& state) const;
  void keep(BodiesMotion& motion) const;
  void put_back(const BodiesMotion& motion);

  // The bodies of a list, as the kernels take them. `answer`: each one's place in the list.
  std::vector<BodyBlock> blocks_of(std::span<const int> numbers) const;
  // One body.
  std::span<const BodyBlock> block_of(std::size_t i) const { return {&alone_[i], 1}; }

  // Where free flight over h leads from the state at t.
  void look_ahead(std::span<const BodyBlock> blocks, double h, const Vector3d& gravity);
  // The state becomes that of the last look-ahead; angular momentum is kept. Whether that moved any.
  bool commit(std::span<const BodyBlock> blocks, double h, const Vector3d& gravity);
  const BodyArrays& arrays() const { return arrays_; }
  const Kernels& kernels() const { return kernels_; }
  // Goes on when load() or put_back() finds a body elsewhere.
  std::uint64_t placements() const { return placements_; }

  std::vector<BodyConstants> constants;
  // State at t, W: centre of mass, velocity, orientation of P and its matrix, angular velocity, inertia.
  std::vector<Vector3d> x, v, w;
  std::vector<Quaterniond> q, q_WB;  // q_WB: of the link's axes, as the world's state has it
  std::vector<Matrix3d> R, inertia, inverse_inertia;
  // Where free flight leads at t+h.
  std::vector<Vector3d> x1;
  std::vector<Quaterniond> q1;
  std::vector<Matrix3d> R1;

 private:
  BodyBlock block(std::span<const int> numbers, std::span<const int> places) const;

  std::vector<int> numbers_;       // by BodyId
  std::vector<char> is_oriented_;  // what is made from q_WB is made
  std::uint64_t placements_ = 1;
  const Kernels& kernels_ = impulse::kernels();
  BodyArrays arrays_{};
  std::vector<BodyBlock> alone_;  // by body
};

// As an assignment; Eigen's would go number by number.
template <typename T>
void copy(const std::vector<T>& from, std::vector<T>& to) {
  to.resize(from.size());
  if (!from.empty())
    std::memcpy(static_cast<void*>(to.data()), static_cast<const void*>(from.data()),
                from.size() * sizeof(T));
}

}  // namespace visum::dynamics::impulse

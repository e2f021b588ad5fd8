// The bodies that the engine moves, as arrays by their number among them: constants, state at t, and where
// free flight leads at t+h. Frame P has the axes of the principal moments of inertia and its origin at the
// centre of mass.
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

enum class Symmetry {
  kNone,
  kTop,
  kBall
};  // of the principal moments: all differ; two are the same; all are

// The constants of a body: kg, kg·m².
struct BodyConstants {
  world::BodyId id;
  double mass = 0.0, inverse_mass = 0.0;
  Vector3d moments;  // principal, in the order of P's axes
  Vector3d inverse_moments;
  Symmetry symmetry = Symmetry::kNone;
  int axis = 2;         // of a top: the axis whose moment differs
  Quaterniond q_BP;     // from P to the link's axes
  bool aligned = true;  // q_BP is the identity
};

// The state at t, kept to be restored if a step fails.
struct BodiesMotion {
  std::vector<Vector3d> x, v, w;
  std::vector<Quaterniond> q_WB;
};

// Plant owns it. On the tick's thread, but look_ahead() and commit(), which several threads may call at a
// time for bodies of their own (plant.h). Nothing here fails. Kernels work on the arrays in blocks of four
// bodies.
class Bodies {
 public:
  Bodies(const world::WorldModel& model, std::int32_t engine_index);
  Bodies(const Bodies&) = delete;
  Bodies& operator=(const Bodies&) = delete;

  std::size_t size() const { return constants.size(); }
  // The number of an extra body that stands for everything that is not this engine's: it rests at the origin,
  // and nobody writes it.
  int still() const { return static_cast<int>(size()); }
  int number(world::BodyId id) const {
    return id.valid() ? numbers_[id.index()] : -1;
  }  // -1: this engine does not move it

  // Loads positions and velocities, and computes what follows from orientations that have changed.
  void load(const world::WorldState& state);
  void store(world::WorldState& state) const;
  // Keeps the state at t, and restores it.
  void keep(BodiesMotion& motion) const;
  void put_back(const BodiesMotion& motion);
  // Restores the places of some bodies, and takes their velocities away.
  void put_to_rest(const BodiesMotion& motion, std::span<const std::size_t> numbers);

  // Groups the bodies of a list in blocks for the kernels. `answer` of a block holds each body's place in the
  // list.
  std::vector<BodyBlock> blocks_of(std::span<const int> numbers) const;
  // A block of one body.
  std::span<const BodyBlock> block_of(std::size_t i) const { return {&alone_[i], 1}; }

  // Flies the bodies freely over h from the state at t; results are in x1, q1, R1.
  void look_ahead(std::span<const BodyBlock> blocks, double h, const Vector3d& gravity);
  // Makes the last look-ahead the state, with angular momentum kept. Returns whether any body has moved.
  bool commit(std::span<const BodyBlock> blocks, double h, const Vector3d& gravity);
  const BodyArrays& arrays() const { return arrays_; }
  const Kernels& kernels() const { return kernels_; }
  // A count that grows whenever load() or put_back() finds a body in another place.
  std::uint64_t placements() const { return placements_; }

  std::vector<BodyConstants> constants;
  // State at t, in W: centre of mass, velocity, orientation of P and its matrix, angular velocity, inertia.
  std::vector<Vector3d> x, v, w;
  std::vector<Quaterniond> q, q_WB;  // q_WB: orientation of the link's axes, as the world's state has it
  std::vector<Matrix3d> R, inertia, inverse_inertia;
  // Where free flight leads at t+h.
  std::vector<Vector3d> x1;
  std::vector<Quaterniond> q1;
  std::vector<Matrix3d> R1;

 private:
  BodyBlock block(std::span<const int> numbers, std::span<const int> places) const;

  std::vector<int> numbers_;       // by BodyId
  std::vector<char> is_oriented_;  // by body: everything that follows from q_WB is computed
  std::uint64_t placements_ = 1;
  const Kernels& kernels_ = impulse::kernels();
  BodyArrays arrays_{};
  std::vector<BodyBlock> alone_;  // by body: a block of it alone
};

// Copies a vector by memcpy: Eigen's assignment would go number by number.
template <typename T>
void copy(const std::vector<T>& from, std::vector<T>& to) {
  to.resize(from.size());
  if (!from.empty())
    std::memcpy(static_cast<void*>(to.data()), static_cast<const void*>(from.data()),
                from.size() * sizeof(T));
}

}  // namespace visum::dynamics::impulse

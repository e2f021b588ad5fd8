// The bodies that the engine moves, as arrays by their number among them: constants, state at t, and where
// they will be at t+h. Frame P: axes of the principal moments of inertia, origin at the centre of mass.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

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

  std::size_t size() const { return constants.size(); }
  int number(world::BodyId id) const { return id.valid() ? numbers_[id.index()] : -1; }  // -1: not ours

  void load(const world::WorldState& state);
  void store(world::WorldState& state) const;
  void keep(BodiesMotion& motion) const;
  void put_back(const BodiesMotion& motion);

  // Where free flight over h leads from the state at t.
  void look_ahead(std::size_t i, double h, const Vector3d& gravity);
  // Where it leads is moved on by a little, rad and m, to first order.
  void nudge(std::size_t i, const Vector3d& shift, const Vector3d& turn);
  // The state becomes that of the last look-ahead; angular momentum is kept.
  void commit(std::size_t i, double h, const Vector3d& gravity);

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
  void orient(std::size_t i);  // q, R and inertia from q_WB
  void turn_inertia(std::size_t i);

  std::vector<int> numbers_;       // by BodyId
  std::vector<char> is_oriented_;  // what is made from q_WB is made
};

}  // namespace visum::dynamics::impulse

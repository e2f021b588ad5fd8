// The paper's own way to hold joints (section 5): one after the other, each closed by an impulse that its two
// bodies alone are asked about, with a look-ahead before each. What one joint's impulse disturbs, the next
// visits put right: Gauss-Seidel. It may stop after any number of corrections, and goes on in the next step
// from what is left.
//
// Symbols: P the joint's point, r from a body's centre of mass to P, (w_k, v_k) the directions that the joint
// holds (joints/), F and T the impulse at P on B, the opposite on A.
//   K_kl = sum over both bodies of  v_k . v_l / m + (w_k + r x v_k) . J^-1 (w_l + r x v_l)
//   K lambda = gap/h,  T = sum lambda_k w_k,  F = sum lambda_k v_k
// The paper's formulas for the spherical joint are the rows v_k = e_k of it. A drive that gives way (axes.cc)
// is one row more, with its compliance added to K's diagonal.
#pragma once

#include "server/dynamics/impulse/plant.h"

namespace visum::dynamics::impulse {

class Corrector {
 public:
  explicit Corrector(Plant& plant);

  // What a mechanism's joints answer to impulses at t. Its joints are placed (Mechanism::place).
  void prepare(std::size_t mechanism, double h);
  // The bodies' velocities are others than a look-ahead has seen.
  void forget_look_ahead(std::size_t mechanism);

  // Visits each joint once and corrects those whose gap (velocity) is above the bound; every other sweep goes
  // backwards. Returns the largest that it found.
  double sweep_gaps(std::size_t mechanism, double h, double d_max, const world::WorldState& state, int sweep);
  double sweep_velocities(std::size_t mechanism, double h, double v_max, int sweep);
  // Brings the look-ahead of all bodies up to date.
  void look_ahead(std::size_t mechanism, double h);

  // Whose gap the last sweep found to be the largest.
  const JointSpec* worst_joint() const { return worst_; }

 private:
  static constexpr std::size_t kNoAxis = static_cast<std::size_t>(-1);
  using Errors = std::array<double, 6>;
  struct Joint {
    const JointSpec* spec = nullptr;
    const JointPose* pose = nullptr;  // at t
    std::size_t own_axis = kNoAxis;   // of Plant::axes
    Axis* axis = nullptr;             // that, where its law is the last row
    Vector3d ra, rb;
    std::size_t count = 0;
    std::array<Vector3d, 6> w, v;
    std::array<Errors, 6> inverse_K;
  };

  void add_joint(std::size_t mechanism, const JointSpec& spec, const JointPose& pose);
  void add_rows(Joint& joint);
  void invert(Joint& joint, double h) const;
  double close_gap(Joint& joint, double h, double d_max, const world::JointState& last);
  double match_velocity(Joint& joint, double h, double v_max);
  void look_ahead(int body, double h);
  Vector3d velocity_at(int body, const Vector3d& r) const;
  void push(Joint& joint, const Errors& errors, Moment moment);
  void push(int body, const Vector3d& r, const Vector3d& T, const Vector3d& F, double sign);

  Plant& plant_;
  std::vector<std::vector<Joint>> joints_;  // by mechanism
  std::vector<char> is_ahead_;              // by body: its look-ahead is of its velocity
  const JointSpec* worst_ = nullptr;
};

}  // namespace visum::dynamics::impulse

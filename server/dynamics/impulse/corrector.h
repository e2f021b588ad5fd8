// The paper's own way to hold joints (section 5), which is Gauss-Seidel: one joint after the other. Each
// joint looks ahead, and an impulse closes it as if its two bodies had no other joints. The next visits put
// right what that disturbs at other joints. It may stop after any number of corrections; the next step goes
// on from what is left.
//
// Symbols: P the joint's point, r from a body's centre of mass to P, (w_k, v_k) the directions that the joint
// holds (joints/), F and T the impulse at P on B; A gets the opposite.
//   K_kl = sum over both bodies of  v_k . v_l / m + (w_k + r x v_k) . J^-1 (w_l + r x v_l)
//   K lambda = gap/h,  T = sum lambda_k w_k,  F = sum lambda_k v_k
// The paper's formulas for the spherical joint are the rows v_k = e_k. A drive that gives way (axes.cc) is
// one more row, with its compliance added to K's diagonal.
#pragma once

#include "server/dynamics/impulse/plant.h"

namespace visum::dynamics::impulse {

// The solver `iterate`. Stepper owns it and uses it on the tick's thread. It does not fail; a NaN comes out
// as the largest gap.
class Corrector {
 public:
  explicit Corrector(Plant& plant);

  // Computes what the mechanism's joints answer to impulses at t. They must be placed (Mechanism::place).
  void prepare(std::size_t mechanism, double h);
  // Tells it that the bodies' velocities have changed since the last look-ahead.
  void forget_look_ahead(std::size_t mechanism);

  // Visits each joint once, and corrects those whose gap (m, rad) or velocity (m/s, rad/s) is above the
  // bound. Every other sweep goes backwards. Returns the largest that it found.
  double sweep_gaps(std::size_t mechanism, double h, double d_max, const world::WorldState& state, int sweep);
  double sweep_velocities(std::size_t mechanism, double h, double v_max, int sweep);
  // Brings the look-ahead of all bodies of the mechanism up to date.
  void look_ahead(std::size_t mechanism, double h);

  // The largest gap of the mechanism's joints at t, when it was prepared.
  double largest_gap(std::size_t mechanism) const;
  // The joint whose gap was the largest in the last sweep.
  const JointSpec* worst_joint() const { return worst_; }

 private:
  static constexpr std::size_t kNoAxis = static_cast<std::size_t>(-1);
  // The miss of each row of a joint, m/s or rad/s.
  using Errors = std::array<double, 6>;
  // A joint with its rows, in the present pose.
  struct Joint {
    const JointSpec* spec = nullptr;
    const JointPose* pose = nullptr;  // at t
    std::size_t own_axis = kNoAxis;   // index in Plant::axes
    Axis* axis = nullptr;             // the same, while its law is the last row
    // Levers of A and B, number of rows, their directions, and the inverse of K.
    Vector3d ra, rb;
    std::size_t count = 0;
    std::array<Vector3d, 6> w, v;
    std::array<Errors, 6> inverse_K;
  };

  void add_joint(std::size_t mechanism, const JointSpec& spec, const JointPose& pose);
  // Finds a joint's levers and rows.
  void add_rows(Joint& joint);
  // Inverts K.
  void invert(Joint& joint, double h) const;
  // Corrects one joint's gap, or its velocity. Returns what it found before.
  double close_gap(Joint& joint, double h, double d_max, const world::JointState& last);
  double match_velocity(Joint& joint, double h, double v_max);
  // Looks ahead with one body, unless that has been done since its velocity changed.
  void look_ahead(int body, double h);
  // Velocity of a body's point at the lever r, m/s.
  Vector3d velocity_at(int body, const Vector3d& r) const;
  // Gives the impulses that take the errors away; the last row's goes to the drive's law.
  void push(Joint& joint, const Errors& errors, Moment moment);
  // Gives the impulse (T, F) at the lever r to one body.
  void push(int body, const Vector3d& r, const Vector3d& T, const Vector3d& F, double sign);

  Plant& plant_;
  std::vector<std::vector<Joint>> joints_;  // by mechanism
  std::vector<char> is_ahead_;              // by body: its look-ahead belongs to its velocity
  const JointSpec* worst_ = nullptr;
};

}  // namespace visum::dynamics::impulse

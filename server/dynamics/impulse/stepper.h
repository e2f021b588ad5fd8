// One step of the method: ballistic look-ahead, impulses at t, and the correction of velocities at t+h. For
// rigid bodies this is SHAKE and RATTLE (Andersen 1983): second order, time-reversible, without drift.
#pragma once

#include <functional>
#include <optional>

#include "server/dynamics/impulse/bounded.h"
#include "server/dynamics/impulse/corrector.h"

namespace visum::dynamics::impulse {

class Stepper {
 public:
  explicit Stepper(Plant& plant);

  // Moves the plant's bodies by h; forces and drives act as they were prepared. False where a joint cannot be
  // closed: the plant is then to be thrown back to where it was, and broken() tells which joint. False, too,
  // where shorter steps are called for; `cuts_left`: how often it may still be cut in halves.
  bool step(double h, std::span<const Wrench> wrenches, const world::WorldState& state, int cuts_left);
  const JointSpec* broken() const { return broken_; }
  // The last step ended with its passes, or its budget, before gaps and velocities were within their bounds.
  bool fell_short() const { return fell_short_; }
  // Poses, directions and factors at t; step() does it, too.
  void factor(double h, const world::WorldState& state);

 private:
  void push(double h, std::span<const Wrench> wrenches);
  void push_axis(const Axis& axis, double impulse);
  bool push_known(std::size_t mechanism, Moment moment, double h);
  void save_velocities();
  void restore_velocities();
  const JointSpec* worst_joint(std::size_t mechanism) const;
  bool break_at(std::size_t mechanism);
  bool has_laws_to_box(std::size_t mechanism) const;
  bool take_laws_as_rows(std::size_t mechanism);
  double d_max(std::size_t mechanism) const { return d_max_by_mechanism_[mechanism]; }
  bool is_too_taut(double h) const;
  void hit(double h);
  bool foresee(double h, std::span<const Wrench> wrenches, const world::WorldState& state);
  bool look_ahead(double h, const world::WorldState& state);
  bool predict(std::size_t mechanism, double h);
  void take_back(std::size_t mechanism, double h);
  double find_gap(std::size_t mechanism, double h, const world::WorldState& state, double law_share);
  void give_answer(std::size_t mechanism, Moment moment);
  bool close_foreseen(std::size_t mechanism, double h, const world::WorldState& state);
  double close(std::size_t mechanism, double h, const world::WorldState& state, int pass);
  bool close_by_newton(std::size_t mechanism, double h, const world::WorldState& state, bool foreseen);
  double correct(std::size_t mechanism, double h, const world::WorldState& state, int sweep);
  bool close_alone(std::size_t mechanism, double h, const world::WorldState& state);
  bool correct_alone(std::size_t mechanism, double h, const world::WorldState& state);
  bool close_together(double h, const world::WorldState& state);
  void look_at_springs(double h, const world::WorldState& state);
  enum class Closed { kYes, kNearly, kNo };
  Closed close_with_rows(double h, const world::WorldState& state, bool gently);
  void note_energy(std::span<const Wrench> wrenches);
  struct Energy {
    double kinetic = 0.0, potential = 0.0;  // J, in gravity
    double weight = 0.0;                    // N, of all of them
  };
  Energy bound_energy() const;
  void give_back_energy(double h);
  void match_velocities(std::size_t mechanism, double h);
  void fly(std::size_t mechanism, double h);
  void commit(double h);
  void correct_velocities(double h, std::span<const Wrench> wrenches, const world::WorldState& state);
  void note_joints();
  void count_impulses();

  Plant& plant_;
  Bounded bounded_;
  std::optional<Corrector> corrector_;      // solver: iterate
  double d_max_;                            // along each axis, as the mechanisms' are
  std::vector<double> d_max_by_mechanism_;  // smaller with loops
  int most_passes_;
  const JointSpec* broken_ = nullptr;
  std::size_t broken_mechanism_ = 0;
  bool fell_short_ = false, divisible_ = false;
  std::vector<std::size_t> bound_bodies_;  // of what has rows, where nothing but gravity can move them
  double energy_before_ = 0.0;             // theirs, before the look-ahead
  std::vector<double> saved_rates_;
  std::vector<Vector3d> saved_v_, saved_w_;
  std::vector<Vector3d> unpushed_v_, unpushed_w_;  // without what is foreseen of joints
};

}  // namespace visum::dynamics::impulse

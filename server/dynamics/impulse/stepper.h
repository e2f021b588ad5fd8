// One step of the method: a ballistic look-ahead, impulses at t that close the joints at t+h, and the
// correction of velocities at t+h. For rigid bodies this is SHAKE and RATTLE (Andersen 1983): second order,
// time-reversible, without drift.
#pragma once

#include <atomic>
#include <functional>
#include <optional>

#include "server/dynamics/impulse/bounded.h"
#include "server/dynamics/impulse/corrector.h"
#include "server/dynamics/impulse/energy_guard.h"

namespace visum::dynamics::impulse {

// Steps one plant. ImpulseEngine owns it and uses it on the tick's thread. A step fails where joints do not
// close or contacts have no solution; the engine then tries shorter steps. Rows and mechanisms keep their
// memory from step to step, so that a step allocates nothing once warm.
class Stepper {
 public:
  explicit Stepper(Plant& plant);

  // How closely and how long the joints of a step are solved.
  struct Bounds {
    double d_max = 0.0;                      // m, rad: largest gap along each axis, without loops
    std::vector<double> d_max_by_mechanism;  // smaller with loops
    int most_passes = 0;                     // of Newton, or corrections of each joint
  };

  // Moves the plant's bodies by h (s), with forces and drives as they were prepared. Returns false where a
  // joint cannot be closed or where shorter steps are needed. The caller must then restore the plant;
  // broken() names the joint, if there is one. `cuts_left`: how often the step may still be cut in halves.
  bool step(double h, std::span<const Wrench> wrenches, const world::WorldState& state, int cuts_left);
  const JointSpec* broken() const { return broken_; }
  // Moves the bodies by h with little work, as far as that goes (stepper_limited.cc). For a tick whose work
  // has met its limit, from its start. The touches' impulses for kAhead say where to start. Returns false
  // where bodies had to stay where they were, at rest.
  bool step_limited(double h, std::span<const Wrench> wrenches, const world::WorldState& state);
  // Numbers of the bodies that the last limited step should have held better; some may appear twice.
  std::span<const std::size_t> short_bodies() const { return short_bodies_; }
  // The last step used up its passes or its budget before gaps and velocities were within their bounds, or
  // took an answer that only comes near one.
  bool fell_short() const { return fell_short_; }
  // With `solver: iterate`, a tick begins: its steps are made joint after joint.
  // `one_thread`: the other threads of the pool take no part.
  void begin_tick(bool one_thread) {
    one_thread_ = one_thread;
    set_firm(false);
  }
  // After a step that failed: the tick's further steps solve all joints at once, as the solver `direct` does.
  // Returns false where they did already.
  bool take_firmly();
  // Its part of the world's state: what `solver: iterate` remembers of energies.
  EnergyGuard& guard() { return guard_; }
  const EnergyGuard& guard() const { return guard_; }
  // Computes poses, directions and factors at t. step() does it, too.
  void factor(double h, const world::WorldState& state);

 private:
  // Gives half of a step's forces to the bodies: wrenches, and feedforwards that no tree takes.
  void push(double h, std::span<const Wrench> wrenches);
  // Impulse on an axis (N·m·s or N·s), applied to its two bodies alone.
  void push_axis(const Axis& axis, double impulse);
  // Hands a mechanism's known impulses (feedforward, laws at their limit) to its tree. Returns true if there
  // are any.
  bool push_known(std::size_t mechanism, Moment moment, double h);
  // Saves velocities of bodies and axes, to solve the same moment again.
  void save_velocities();
  void restore_velocities();
  // The joint with the largest gap in the last look-ahead; null where there is none.
  const JointSpec* worst_joint(std::size_t mechanism) const;
  // Notes the joint that does not close. Always returns false.
  bool break_at(std::size_t mechanism);
  // True if a law in the tree could do better as a row: only mechanisms with loops have such laws.
  bool has_laws_to_box(std::size_t mechanism) const;
  // Turns these laws into rows. Returns false where there are none.
  bool take_laws_as_rows(std::size_t mechanism);
  // Largest gap that is allowed, along each axis of W: m, rad.
  double d_max(std::size_t mechanism) const { return bounds_.d_max_by_mechanism[mechanism]; }
  // True if a link would swing too far in this step under the tension of its joint (predicting.cc).
  bool is_too_taut(double h) const;
  // Solves the collisions at t.
  void hit(double h);
  // Finds the impulses at t, again from the start where a law turns out to be at its limit. False: no
  // solution.
  bool foresee(double h, std::span<const Wrench> wrenches, const world::WorldState& state);
  // Looks ahead and closes the joints of all mechanisms, with rows where there are any. False: no solution.
  bool look_ahead(double h, const world::WorldState& state);
  // Gives the impulses that the last steps predict. False where too little is known.
  bool predict(std::size_t mechanism, double h);
  // Takes everything back that was given to a mechanism at t.
  void take_back(std::size_t mechanism, double h);
  // Looks ahead and asks the tree to close the gaps. Returns the largest gap in m or rad, or how far a law
  // misses; that part is divided by `law_share`.
  double find_gap(std::size_t mechanism, double h, const world::WorldState& state, double law_share);
  // Solves what was asked, and applies the answer to the bodies.
  void give_answer(std::size_t mechanism, Moment moment);
  // Returns how much the mechanism's last answer leaves of its joints' gaps where the look-ahead follows it
  // to first order: m or rad.
  double left_by_answer(std::size_t mechanism, double h) const;
  bool may_follow(std::size_t mechanism) const;
  // Moves the look-ahead along with that answer, to first order.
  void nudge(std::size_t mechanism, double h);
  // The same if it leaves next to nothing, along with what answers since the last flight have left. Otherwise
  // returns false, and the mechanism has to fly again.
  bool follow_answer(std::size_t mechanism, double h);
  // Corrects what the prediction left. False where the prediction is of no use.
  bool close_foreseen(std::size_t mechanism, double h, const world::WorldState& state);
  // Like find_gap(), for a pass of Newton.
  double find_gap_of_pass(std::size_t mechanism, double h, const world::WorldState& state, int pass);
  // One pass of Newton over a mechanism. Returns the gap that it found.
  double close(std::size_t mechanism, double h, const world::WorldState& state, int pass);
  // Newton's passes until the gap is small enough. `foreseen`: known impulses have been given already.
  bool close_by_newton(std::size_t mechanism, double h, const world::WorldState& state, bool foreseen);
  // One sweep of the iterative solver over a mechanism. Returns the largest gap that it found.
  double correct(std::size_t mechanism, double h, const world::WorldState& state, int sweep);
  // Closes a mechanism on which no row acts. False: it does not close.
  bool close_alone(std::size_t mechanism, double h, const world::WorldState& state);
  // The same with the iterative solver.
  bool correct_alone(std::size_t mechanism, double h, const world::WorldState& state);
  // An island notes here how closing it went, since others may be closed at the same time.
  struct Fate {
    const JointSpec* broken = nullptr;  // the joint with the largest gap
    std::size_t mechanism = 0;          // its own
    bool fell_short = false;
    bool tried = false;
    bool followed = false;   // the look-ahead has followed the last answers
    std::size_t worker = 0;  // that closes it
  };
  // Takes over what an island's closing has noted.
  void note(const Fate& fate);
  // Calls work(worker, island), which returns whether all is well, for each island with rows: side by side if
  // that is allowed, otherwise in order up to the first that is not. Returns whether all were.
  template <typename Work>
  bool for_islands(Work work);
  // Closes all mechanisms of an island on which rows act, together with the rows.
  bool close_together(std::size_t island, double h, const world::WorldState& state, Fate& fate);
  // Lets the look-ahead follow what rows have just done to an island's mechanisms. False: one has to fly
  // again.
  bool follow_rows(std::size_t island, double h);
  // Looks ahead with the island's bodies without joints, and measures its springs there.
  void look_at_springs(std::size_t island, double h, const world::WorldState& state);
  // How far closing with rows has come: within the bounds, near enough to go on, or neither.
  enum class Closed { kYes, kNearly, kNo };
  // Alternates passes over joints and rows. `gently`: a few passes only, and what the rows then miss is left.
  Closed close_with_rows(std::size_t island, double h, const world::WorldState& state, bool gently,
                         Fate& fate);
  // One pass over the joints of an island's mechanisms with rows. Returns the largest gap, and notes whose it
  // is; `closed`: all are within their bounds.
  double close_joints(std::size_t island, double h, const world::WorldState& state, int pass, bool& closed,
                      Fate& fate);
  // Notes the energy before the look-ahead, of islands with rows where nothing but gravity does work.
  void note_energy(std::span<const Wrench> wrenches);
  bool is_worked_on(std::size_t island, std::span<const Wrench> wrenches) const;
  struct Energy {
    double kinetic = 0.0, potential = 0.0;  // J
    double weight = 0.0;                    // N, of all of these bodies
  };
  // An island's share of bound_bodies_.
  struct Watched {
    std::size_t first, count;
    double energy_before;  // J, theirs before the look-ahead
  };
  // Their present energy.
  Energy energy_of(const Watched& watched) const;
  // Slows the bodies of an island down if the step has gained energy there.
  void give_back_energy(double h);
  // Makes the joints' velocities of a mechanism agree at t+h. `first`: with the drives' known impulses.
  void match_velocities(std::size_t mechanism, double h, bool first = true);
  // Look-ahead of a mechanism's bodies.
  void fly(std::size_t mechanism, double h);
  // Moves all bodies to where the last look-ahead has led.
  void commit(double h);
  // The second half of the step: forces, joints and rows at t+h.
  void begin_after(const world::WorldState& state);
  void solve_each_island();
  void correct_velocities(double h, std::span<const Wrench> wrenches, const world::WorldState& state);
  // stepper_limited.cc: the parts of step_limited().
  void foresee_limited(double h, std::span<const Wrench> wrenches, const world::WorldState& state);
  void look_ahead_limited(double h, const world::WorldState& state);
  void correct_velocities_limited(double h, std::span<const Wrench> wrenches, const world::WorldState& state);
  // Makes rows of all laws.
  void box_laws();
  // stepper_iterate.cc: with `solver: iterate`, whether the look-ahead keeps the joints together; whether the
  // step gained no energy, or what it gained could be taken back.
  bool holds_together(double h, const world::WorldState& state);
  bool keep_energy(double h, std::span<const Wrench> wrenches);
  // Closes the gaps that firm steps find, without motion.
  void move_together(double h, const world::WorldState& state);
  double fastest_turn() const;  // rad/s, of all linked bodies
  void set_firm(bool firm);
  // Tells the predictions what the joints gave in this step.
  void note_joints();
  // Adds the step's impulses to the tick's totals.
  void count_impulses();

  Plant& plant_;
  Bounded bounded_;
  std::optional<Corrector> corrector_;           // only with solver: iterate
  bool iterates_ = false;                        // joint after joint in this step
  bool firm_ = false;                            // solver: iterate, but this step solves all joints at once
  double prepared_h_ = 0.0;                      // s: the step that the corrector was prepared for; 0: none
  double began_apart_ = 0.0, left_apart_ = 0.0;  // m, rad: largest gap that a step finds, and leaves
  Bounds bounds_, firm_bounds_;                  // of this step, of the other kind of step
  const JointSpec* broken_ = nullptr;
  std::size_t broken_mechanism_ = 0;
  bool fell_short_ = false, divisible_ = false;
  bool one_thread_ = false;  // in this tick
  std::vector<Fate> fates_;  // by island
  // By mechanism with rows: m or rad that the answers since its last flight leave of its joints' gaps.
  std::vector<double> left_;
  // Islands with rows on mechanisms where nothing but gravity does work, and their bodies.
  std::vector<Watched> watched_;
  std::vector<std::size_t> bound_bodies_;
  EnergyGuard guard_;                      // of a limited step, and of all steps of `solver: iterate`
  std::vector<std::size_t> short_bodies_;  // in it
  // By axis, by body: at the start of the moment that is solved.
  std::vector<double> saved_rates_;
  std::vector<Vector3d> saved_v_, saved_w_;
  std::vector<Vector3d> unpushed_v_, unpushed_w_;  // before what is foreseen of the joints was given
};

template <typename Work>
bool Stepper::for_islands(Work work) {
  const std::size_t count = plant_.islands.size();
  if (one_thread_ || iterates_ || count < 2 || plant_.pool.threads() == 1) {
    for (std::size_t i = 0; i < count; ++i)
      if (bounded_.has_rows(i) && !work(0, i)) return false;
    return true;
  }
  std::atomic<bool> well = true;
  auto guarded = [&](std::size_t worker, std::size_t i) {
    try {
      if (bounded_.has_rows(i) && !work(worker, i)) well.store(false, std::memory_order_relaxed);
    } catch (const WorkSpent&) {
      well.store(false, std::memory_order_relaxed);
    }
  };
  plant_.work.share(true);
  plant_.pool.run(count, guarded);
  plant_.work.share(false);
  if (!well.load(std::memory_order_relaxed)) throw NeedsOneThread{};
  return true;
}

}  // namespace visum::dynamics::impulse

// One step of the whole plant: that of each island (island_stepper.h), and what concerns all of them.
#pragma once

#include <atomic>
#include <memory>
#include <optional>

#include "server/dynamics/impulse/energy_guard.h"
#include "server/dynamics/impulse/island_stepper.h"
#include "server/dynamics/impulse/standing.h"
#include "server/dynamics/step_input.h"

namespace visum::dynamics::impulse {

// Steps one plant. ImpulseEngine owns it and uses it on the tick's thread; the islands' steps may run on the
// threads of the plant's pool. A step fails where joints do not close or contacts have no solution; the
// engine then tries shorter steps.
class Stepper {
 public:
  explicit Stepper(Plant& plant);
  Stepper(const Stepper&) = delete;
  Stepper& operator=(const Stepper&) = delete;

  // Makes the touches that the plant lists, with what the warm start knows of them. `may_stand`: the tick
  // begins, and islands that stand need not be computed.
  void load_touches(const StepInput& input, const world::WorldState& state, const WarmStart& warm_start,
                    bool may_stand);
  const Standing& standing() const { return standing_; }
  // The tick was made. Keeps what the next one needs to tell which islands stand.
  void note_standing(const StepInput& input, const WarmStart& warm_start) {
    standing_.note(input.contacts, warm_start, fates_);
  }
  // Moves the plant's bodies by h (s), with forces and drives as they were prepared. Returns false where a
  // joint cannot be closed or where shorter steps are needed. The caller must then restore the plant;
  // broken() names the joint, if there is one. `cuts_left`: how often the step may still be cut in halves.
  bool step(double h, std::span<const Wrench> wrenches, const world::WorldState& state, int cuts_left);
  const JointSpec* broken() const { return broken_; }
  // Moves the bodies by h with little work, as far as that goes (island_limited.cc). For a tick whose work
  // has met its limit, from its start. The touches' impulses for kAhead say where to start. Returns false
  // where bodies had to stay where they were, at rest.
  bool step_limited(double h, std::span<const Wrench> wrenches, const world::WorldState& state);
  // Numbers of the bodies that the last limited step should have held better; some may appear twice. Their
  // rows are looked at before what has gained energy is slowed down.
  std::span<const std::size_t> short_bodies() const { return short_bodies_; }
  // The last step used up its passes or its budget before gaps and velocities were within their bounds, or
  // took an answer that only comes near one.
  bool fell_short() const { return fell_short_; }
  // A tick begins; with `solver: iterate` its steps are made joint after joint. `one_thread`: the other
  // threads of the pool take no part in it. Comes before load_touches().
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
  void begin_step(double h, std::span<const Wrench> wrenches, const world::WorldState& state);
  bool are_side_by_side() const {
    return !one_thread_ && !plan_.iterates && plant_.islands.size() > 1 && plant_.pool.threads() > 1;
  }
  // Calls work(thread, island) for each island, on the threads of the pool.
  template <typename Work>
  void run_side_by_side(Work work) {
    plant_.pool.run(
        plant_.islands.size(), [this](std::size_t i) { return cost(i); }, work);
  }
  // Calls work(stepper, island, fate), which returns whether all is well, for each island, side by side if
  // that is allowed. Returns whether all were. None is left out where another one is not well, so that the
  // work is the same with any number of threads.
  template <typename Work>
  bool for_islands(Work work);
  // Makes a moment of an island that stands. Returns false where it has to be computed.
  bool stand(IslandStepper& by, std::size_t island, Moment moment);
  // How long an island's step takes, roughly, in any unit.
  std::size_t cost(std::size_t island) const;
  // Takes over what has been noted about the islands.
  void read_fates();
  // Moves the bodies without joints, once all islands have foreseen.
  void move_free();
  // Sleeping contacts repeat what they gave in the last tick.
  void count_sleeping();
  // stepper_iterate.cc: with `solver: iterate`, whether the look-ahead keeps the joints together; whether the
  // step gained no energy, or what it gained could be taken back.
  bool holds_together();
  bool keep_energy();
  // Closes the gaps that firm steps find, without motion.
  void move_together();
  double fastest_turn() const;  // rad/s, of all linked bodies
  void set_firm(bool firm);

  Plant& plant_;
  StepPlan plan_;
  StepScratch scratch_;
  Standing standing_;
  std::vector<WorkBudget> more_work_;                     // of the threads beyond the first
  std::vector<std::unique_ptr<IslandStepper>> steppers_;  // by thread of the pool
  std::vector<IslandFate> fates_;                         // by island
  std::optional<Corrector> corrector_;                    // only with solver: iterate
  StepPlan::Bounds firm_bounds_;                          // of the other kind of step
  bool firm_ = false;                            // solver: iterate, but this step solves all joints at once
  double began_apart_ = 0.0, left_apart_ = 0.0;  // m, rad: largest gap that a step finds, and leaves
  const JointSpec* broken_ = nullptr;
  bool fell_short_ = false;
  bool one_thread_ = false;                // in this tick
  EnergyGuard guard_;                      // of a limited step, and of all steps of `solver: iterate`
  std::vector<std::size_t> short_bodies_;  // in it
};

template <typename Work>
bool Stepper::for_islands(Work work) {
  if (!are_side_by_side()) {
    bool well = true;
    for (std::size_t i = 0; i < plant_.islands.size(); ++i) well = work(*steppers_[0], i, fates_[i]) && well;
    return well;
  }
  std::atomic<bool> well = true, spent = false;
  for (WorkBudget& of_thread : more_work_) of_thread.start(plant_.work.left());
  run_side_by_side([&](std::size_t thread, std::size_t i) {
    try {
      if (!work(*steppers_[thread], i, fates_[i])) well.store(false, std::memory_order_relaxed);
    } catch (const WorkSpent&) {
      spent.store(true, std::memory_order_relaxed);
    }
  });
  std::uint64_t taken = 0;
  for (const WorkBudget& of_thread : more_work_) taken += of_thread.taken();
  if (spent.load(std::memory_order_relaxed) || taken > plant_.work.left()) throw NeedsOneThread{};
  plant_.work.take(taken);
  return well.load(std::memory_order_relaxed);
}

}  // namespace visum::dynamics::impulse

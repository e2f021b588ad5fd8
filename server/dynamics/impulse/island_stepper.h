// One step of one island (islands.h): a ballistic look-ahead, impulses at t that close the joints at t+h, and
// the correction of velocities at t+h. For rigid bodies this is SHAKE and RATTLE (Andersen 1983): second
// order, time-reversible, without drift.
#pragma once

#include "server/dynamics/impulse/bounded.h"
#include "server/dynamics/impulse/corrector.h"

namespace visum::dynamics::impulse {

// Common to the steps of all islands. Stepper fills it; it does not change during a step.
struct StepPlan {
  // How closely and how long the joints of a step are solved.
  struct Bounds {
    double d_max = 0.0;                      // m, rad: largest gap along each axis, without loops
    std::vector<double> d_max_by_mechanism;  // smaller with loops
    int most_passes = 0;                     // of Newton, or corrections of each joint
  };

  double h = 0.0;  // s
  std::span<const Wrench> wrenches;
  const world::WorldState* state = nullptr;  // of the tick
  Bounds bounds;
  bool divisible = false;          // the step may still be cut in halves
  bool minds_tension = false;      // a joint's tension may ask for shorter steps
  Corrector* corrector = nullptr;  // only with solver: iterate
  bool iterates = false;           // joint after joint, by the corrector
};

// Notes about an island during a step.
struct IslandFate {
  const JointSpec* broken = nullptr;  // the joint with the largest gap, where there is no solution
  std::size_t mechanism = 0;          // its own
  bool fell_short = false;
  bool followed = false;  // the look-ahead has followed the last answers
  bool inexact = false;   // the answer of the look-ahead or at t+h is (Bounded::is_inexact)
  bool wedged = false;    // contacts were found to be wedged: the look-ahead is to be made again
  bool held = false;      // of a limited step: its joints do not close, so that it stays where it was
  std::array<std::uint64_t, kMoments> work{};  // units that the look-ahead and the end of the step have taken
  Course course;
  // Where nothing but gravity and drives does work on joints with rows, or on many contacts: the energy
  // before the look-ahead, J.
  bool watched = false;
  double energy_before = 0.0;
};

// Numbers that are kept during a step, by body, axis or mechanism. Each island has its own of them.
struct StepScratch {
  explicit StepScratch(const Plant& plant)
      : rates(plant.axes.size()),
        v(plant.bodies.size()),
        w(plant.bodies.size()),
        unpushed_v(plant.bodies.size()),
        unpushed_w(plant.bodies.size()),
        left(plant.mechanisms.size()),
        prepared_h(plant.mechanisms.size()) {}

  std::vector<double> rates;                     // at the start of the moment that is solved
  std::vector<Vector3d> v, w;                    // likewise
  std::vector<Vector3d> unpushed_v, unpushed_w;  // before what is foreseen of the joints was given
  std::vector<double> left;        // m, rad that the answers since the last flight leave of the joints' gaps
  std::vector<double> prepared_h;  // s: the step that the corrector was prepared for; 0: none
};

// Steps one island after the other. Stepper owns one for each thread of the pool, which uses it alone: it
// writes nothing but its island. Bodies without joints fly in between, when all islands have
// foreseen. Rows keep their memory from step to step, so that a step allocates nothing once warm.
class IslandStepper {
 public:
  // `work`: its part of the tick's work. foresee() and correct() may throw WorkSpent.
  IslandStepper(Plant& plant, const StepPlan& plan, StepScratch& scratch, WorkBudget& work)
      : plant_(plant), plan_(plan), kept_(scratch), work_(work), bounded_(plant, work) {}

  // Finds the impulses at t, again from the start where a law turns out to be at its limit. False: there is
  // no solution, or a shorter step is needed.
  bool foresee(std::size_t island, IslandFate& fate);
  // The second half of the step: moves the mechanisms, then forces, joints and rows at t+h.
  void correct(std::size_t island, IslandFate& fate);
  // Adds the impulses to the tick's totals, and carries contacts and predictions on.
  void finish(std::size_t island);
  void count_impulses(std::size_t island);  // the first part of that
  // Computes poses, directions and factors at t.
  void factor(std::size_t island);
  // Takes the work of an island that is not computed (standing.h).
  void take(std::uint64_t units) { work_.take(units); }

  // island_limited.cc: the same with little work. `found`: appends the bodies that should have been held
  // better.
  void foresee_limited(std::size_t island, IslandFate& fate);
  void correct_limited(std::size_t island, IslandFate& fate, std::vector<std::size_t>& found);

 private:
  void begin(std::size_t island, IslandFate& fate) {
    island_ = island;
    fate_ = &fate;
  }
  std::span<const std::size_t> mechanisms() const { return plant_.islands.mechanisms(island_); }
  std::span<const std::size_t> bodies() const { return plant_.islands.bodies(island_); }
  const world::WorldState& state() const { return *plan_.state; }
  Corrector& corrector() const { return *plan_.corrector; }
  // Calls act(m) for each mechanism that does not sleep.
  template <typename Act>
  void each_awake(Act act) const {
    for (const std::size_t m : mechanisms())
      if (!plant_.mechanism_asleep[m]) act(m);
  }

  // Gives half of a step's forces to the bodies: wrenches, and feedforwards that no tree takes.
  void push();
  // Impulse on an axis (N·m·s or N·s), applied to its two bodies alone.
  void push_axis(const Axis& axis, double impulse);
  // Hands a mechanism's known impulses (feedforward, laws at their limit) to its tree. Returns true if there
  // are any.
  bool push_known(std::size_t mechanism, Moment moment);
  // Saves velocities of bodies and axes, to solve the same moment again.
  void save_velocities();
  void restore_velocities();
  void copy(const std::vector<Vector3d>& from, std::vector<Vector3d>& to) const;  // of the island's bodies
  void factor(Moment moment);  // with the laws that are in the tree at this moment
  // The joint with the largest gap in the last look-ahead; null where there is none.
  const JointSpec* worst_joint(std::size_t mechanism) const;
  // Notes the joint that does not close. Always returns false.
  bool break_at(std::size_t mechanism);
  // True if a law in the tree could do better as a row: only mechanisms with loops have such laws.
  bool has_laws_to_box(std::size_t mechanism);
  // Turns these laws into rows. Returns false where there are none.
  bool take_laws_as_rows(std::size_t mechanism);
  // Turns dry friction into rows where contacts push a mechanism about.
  void take_friction_as_rows();
  // Turns laws without compliance into rows, where another row misses and nothing can move it. Returns
  // whether there were any.
  bool take_rigid_laws_as_rows();
  // Largest gap that is allowed, along each axis of W: m, rad.
  double d_max(std::size_t mechanism) const { return plan_.bounds.d_max_by_mechanism[mechanism]; }
  // True if a link would swing too far in this step under the tension of its joint (predicting.cc).
  bool is_too_taut();
  // True if contacts may be found to be wedged: at all, and before the drives' laws have settled.
  bool knows_wedges() const;
  bool may_mind_wedges();
  // Sets the impulses that the rows at t+h start from.
  void start_after();
  bool find_impulses();
  // Sets everything back to where the look-ahead starts, and brings poses and factors up to date.
  void begin_ahead(bool again);
  // Solves the collisions at t. Springs on axes take no part in them.
  void hit();
  bool has_sprung_axes() const;
  // Looks ahead and closes the joints of all mechanisms, with rows where there are any. False: no solution.
  bool look_ahead();
  // Gives the impulses that the last steps predict. False where too little is known.
  bool predict(std::size_t mechanism);
  // Takes everything back that was given to a mechanism at t.
  void take_back(std::size_t mechanism);
  // Looks ahead and asks the tree to close the gaps. Returns the largest gap in m or rad, or how far a law
  // misses; that part is divided by `law_share`.
  double find_gap(std::size_t mechanism, double law_share);
  // Solves what was asked, and applies the answer to the bodies.
  void give_answer(std::size_t mechanism, Moment moment);
  // Returns how much the mechanism's last answer leaves of its joints' gaps where the look-ahead follows it
  // to first order: m or rad.
  double left_by_answer(std::size_t mechanism) const;
  bool may_follow(std::size_t mechanism) const;
  // Moves the look-ahead along with that answer, to first order.
  void nudge(std::size_t mechanism);
  // The same if it leaves next to nothing, along with what answers since the last flight have left. Otherwise
  // returns false, and the mechanism has to fly again.
  bool follow_answer(std::size_t mechanism);
  // Corrects what the prediction left. False where the prediction is of no use.
  bool close_foreseen(std::size_t mechanism);
  // Like find_gap(), for a pass of Newton.
  double find_gap_of_pass(std::size_t mechanism, int pass);
  // One pass of Newton over a mechanism. Returns the gap that it found.
  double close(std::size_t mechanism, int pass);
  // Newton's passes until the gap is small enough. `foreseen`: known impulses have been given already.
  bool close_by_newton(std::size_t mechanism, bool foreseen);
  // One sweep of the iterative solver over a mechanism. Returns the largest gap that it found.
  double correct(std::size_t mechanism, int sweep);
  // Closes a mechanism on which no row acts. False: it does not close.
  bool close_alone(std::size_t mechanism);
  // The same with the iterative solver.
  bool correct_alone(std::size_t mechanism);
  // Closes all mechanisms on which rows act, together with the rows.
  bool close_together();
  // Lets the look-ahead follow what rows have just done to the mechanisms. False: one has to fly again.
  bool follow_rows();
  // Looks ahead with the bodies without joints, and measures springs there.
  void look_at_springs();
  // How far closing with rows has come: within the bounds, near enough to go on, or neither.
  enum class Closed { kYes, kNearly, kNo };
  // Alternates passes over joints and rows. `gently`: a few passes only, and what the rows then miss is left.
  Closed close_with_rows(bool gently);
  // One pass over the joints of the mechanisms with rows. Returns the largest gap, and notes whose it is;
  // `closed`: all are within their bounds.
  double close_joints(int pass, bool& closed);
  // Notes the energy before the look-ahead, where rows act on joints and gravity and drives alone do
  // work.
  void note_energy();
  bool is_worked_on();
  struct Energy {
    double kinetic = 0.0, potential = 0.0;  // J
    double mass = 0.0;                      // kg, of all bodies
  };
  Energy energy() const;
  double given_by_drives() const;
  double given_by_overlaps(double mass) const;
  // Slows the bodies down if the step has gained energy.
  void give_back_energy();
  // Makes the joints' velocities of a mechanism agree at t+h. `first`: with the drives' known impulses.
  void match_velocities(std::size_t mechanism, bool first = true);
  // Look-ahead of a mechanism's bodies.
  void fly(std::size_t mechanism);
  // Moves the mechanisms to where the last look-ahead has led.
  void commit();
  // Springs push at t+h, and rows start from what they gave at t.
  void begin_after();
  bool find_velocities();  // those at t+h; false: laws changed too often
  // island_limited.cc: look-ahead and velocities of a limited step.
  void look_ahead_limited();
  void find_velocities_limited();
  // Makes rows of all laws.
  void box_laws();

  Plant& plant_;
  const StepPlan& plan_;
  StepScratch& kept_;
  WorkBudget& work_;
  Bounded bounded_;
  std::size_t island_ = 0;
  bool minds_wedges_ = false;  // the look-ahead stops where contacts are found to be wedged
  IslandFate* fate_ = nullptr;
};

}  // namespace visum::dynamics::impulse

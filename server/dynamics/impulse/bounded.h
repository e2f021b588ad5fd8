// The rows (rows.h) of one moment of an island's step: which contacts, stops, laws, dampers and springs may
// bind, what each of them asks for, and how the impulses come back to bodies and mechanisms.
#pragma once

#include "server/dynamics/impulse/plant.h"
#include "server/dynamics/impulse/rows.h"

namespace visum::dynamics::impulse {

// Fastest separation of overlapping bodies: a body that starts inside another one is not shot out of it.
inline constexpr double kMostPush = 0.5;  // m/s

// How an island's look-ahead was solved. It counts at the end of the step, too.
struct Course {
  bool rests = true;     // nothing had to be solved
  bool frozen = false;   // and the island stood still
  bool still = false;    // solved or not, it stood still
  int still_before = 0;  // for how many steps before this one it had stood still
  bool gently = false;   // solves by a few softened sweeps
};

// Builds the rows of one moment of an island (islands.h), and solves them. Order of calls: build(), then
// solve() or bounce() any number of times, then report(). IslandStepper owns it and uses it on its thread.
// solve() may return NaN or infinity where the rows have no answer; the caller looks at that.
class Bounded {
 public:
  Bounded(Plant& plant, WorkBudget& work);

  // Makes the rows that may bind at this moment. They start from the impulses of the last tick or of the
  // moment before. The mechanisms must be factored. `course` begins with the look-ahead, and must last as
  // long as the rows.
  void build(std::size_t island, Moment moment, double h, Course& course);
  bool has_rows() const { return !blocks_.empty(); }
  // True if a body that the scene or another engine moves does move, and touches the island.
  bool is_dragged() const;
  // Numbers of the bodies without joints that have rows.
  std::span<const std::size_t> free_bodies() const { return slotted_; }
  // True if any row acts on the mechanism, which is one of the island.
  bool binds(std::size_t mechanism) const { return plant_.mechanism_bound[mechanism] != 0; }

  // Solves the rows with the bodies' present velocities, and changes them. Returns the largest miss before:
  // by how much the velocities were not as the rows ask, m/s or rad/s.
  double solve();
  // After solve(), with the bodies' present velocities: true if a row that nothing can move misses more than
  // `enough`, m/s or rad/s.
  bool misses_where_stuck(double enough) const;
  // True if no row missed more than it may after the last solve().
  bool is_solved() const { return system_.solved; }
  // True if the last solve() ended with an answer that misses more, since an exact one would be dear. Hits
  // and bodies that stand never take such an answer.
  bool is_inexact() const { return system_.inexact; }
  // True if the last solve() has changed any velocity.
  bool has_changed() const { return system_.changed; }
  // Undoes all that solve() has done: impulses go to zero, and bodies without joints get the velocities `v`
  // and `w` (by body). From now on, until the end of the step, the rows are softened and solved by a few
  // sweeps only.
  void start_gently(std::span<const Vector3d> v, std::span<const Vector3d> w);
  // While set, for a limited step: rows see every body as if it had no joints, so that they need no response
  // of a mechanism; solve() takes a few sweeps; and nothing is driven out of an overlap, which takes energy.
  void take_apart(bool apart) { apart_ = apart; }
  // While taken apart, after solve(): appends the numbers of the bodies whose rows miss more than `enough`
  // (m/s or rad/s); some may appear several times.
  void find_short(double enough, std::vector<std::size_t>& found);
  // Writes the rows' impulses to the touches, axes and springs.
  void report();
  // Marks contacts that press so hard that they must be wedged (bounded_wedges.cc). Returns true if there are
  // new ones: all is to be solved again then.
  bool mark_wedges();
  // Solves a collision, after build(kHit), by Newton's law of restitution or by Poisson's.
  void bounce();

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  // The kind of thing that a block of rows belongs to.
  enum class Of { kTouch, kTwist, kLaw, kDamping, kStop, kSpring };
  // The thing that a block belongs to: its index in the plant's list, and for a stop its side.
  struct Owner {
    Of of;
    std::size_t index = 0, side = 0;  // side: of a stop
  };
  // One row on a mechanism.
  struct MechanismRow {
    const Axis* axis = nullptr;  // an axis of the tree; null: `line` says the motion
    PathMotion line;
    // The row's response to itself, 1/kg or 1/(kg·m²): of an axis of the tree as if there were no loops, of
    // an axis that closes a loop as if there were no joints. 0: not known.
    double without_loops = 0.0;
  };
  // All rows on one mechanism.
  struct MechanismRows {
    std::vector<MechanismRow> rows;
    std::size_t offset = 0, response = 0;  // where they begin in the island's velocities and responses
  };
  // Forgets the rows of the last moment; keeps the memory.
  void reset();
  void add_rows();
  // True if nothing in the island is driven out of an overlap.
  bool is_calm() const;
  // True if no body without joints moves faster than it would fall in two steps.
  bool stands() const;
  // True if a contact starts with the load of a high heap on it, or of a heavy body on a light one.
  bool carries_many() const;
  // Adds the three rows of a contact, and those of its twist.
  void add_touch(std::size_t index);
  // Adds the rows of rolling and torsional friction; comes right after its contact.
  void add_twist(std::size_t index);
  // Adds the rows of an axis: its law, its damping, its stops.
  void add_axis(std::size_t index);
  void add_law(std::size_t index);
  void add_stop(std::size_t index, std::size_t side);
  void add_spring(std::size_t index);
  // Adds an empty block of `dim` rows.
  RowBlock& add_block(Owner owner, std::size_t dim);
  // Connects a block of one row to an axis, in the tree or closing a loop.
  void connect_axis(RowBlock& block, const Axis& axis);
  // The same to the axis' two bodies, as if they had no joints.
  void connect_axis_apart(RowBlock& block, const Axis& axis);
  // Connects a block to bodies a and b, each free or part of a mechanism.
  template <typename FindA, typename FindB>
  void connect_bodies(RowBlock& block, int a, int b, FindA find_a, FindB find_b);
  // Adds an end on a body without joints, and gives the body a place in the velocities.
  RowEnd& add_free_end(RowBlock& block, std::size_t body);
  // Computes what an impulse on each row does to a body without joints.
  void respond(RowBlock& block, RowEnd& end, int body) const;
  // Connects a block to one or two bodies of the same mechanism, given the rows' directions there.
  void connect_mechanism(RowBlock& block, int a, const Reach* at_a, int b, const Reach* at_b);
  RowEnd& add_mechanism_end(RowBlock& block, int mechanism);
  // Marks the mechanisms that have rows.
  void mark_bound();
  // Lays out velocities and responses once all rows are known.
  void lay_out();
  // Tells the blocks' ends where their mechanism's rows are, and finds all responses.
  void connect_responses();
  MechanismRows& rows_of(std::size_t mechanism) { return of_mechanism_[place_[mechanism]]; }
  const MechanismRows& rows_of(std::size_t mechanism) const { return of_mechanism_[place_[mechanism]]; }
  // Computes W of a mechanism: what a unit impulse on each of its rows does to all of them.
  void find_response(std::size_t mechanism, double* W);
  // Follows the rows' ways through a tree. Returns false where they are too long for Tree::find_response().
  bool trace_rows(std::size_t mechanism);
  void find_response_row_by_row(std::size_t mechanism, double* W);
  // Velocity of a row in the mechanism's last answer, rad/s or m/s.
  double rate_in_answer(std::size_t mechanism, const MechanismRow& row) const;

  // Sets target, bounds and compliance of every block for this moment; one function for each kind of owner.
  void aim();
  void aim_touch(RowBlock& block, const Touch& touch, double bounce) const;
  void aim_twist(RowBlock& block, const Touch& touch) const;
  void aim_law(RowBlock& block, const Axis& axis) const;
  void aim_damping(RowBlock& block, const Axis& axis) const;
  void aim_stop(RowBlock& block, const Axis& axis, std::size_t side) const;
  void aim_spring(RowBlock& block, const Spring& spring) const;
  // Loads velocities, solves the rows as they are aimed, stores velocities. Returns the largest miss before.
  double solve_rows();
  // Lets the contacts yield that are marked as wedged.
  void let_wedges_yield();
  // The fastest velocity, m/s, that a contact's normal would miss if no contact gave an impulse.
  double largest_need();
  // Second half of a collision by Poisson's law.
  void restore_by_poisson();
  // Cuts the bounces of a collision by Newton's law down until no contact gains energy.
  void keep_energy();
  // Work of a block's impulses on its bodies during a hit, J; 0 where it is no more than rounding.
  double work(std::size_t block) const;
  // How the last tick has left the island.
  struct Rest {
    bool rested = false;  // no impulse of a contact had to change, or next to nothing moved
    int still = 0;        // for how many ticks next to nothing had moved
  };
  Rest last_rest() const;  // bounded_rest.cc
  // Notes what the moment says of rest. `still`: nothing moves.
  void note_rest(bool still);
  std::span<const std::size_t> mechanisms() const { return plant_.islands.mechanisms(island_); }
  // Copies the velocities of bodies and mechanisms into the rows, and what the rows changed back.
  void load_velocities();
  void store_velocities();
  void push_mechanisms();
  // Present velocity of a mechanism's row, rad/s or m/s.
  double velocity(std::size_t mechanism, const MechanismRow& row) const;

  Plant& plant_;
  WorkBudget& work_;
  Rows rows_;
  RowIsland system_;  // what rows_ solves: the lists below
  std::vector<RowBlock> blocks_;
  std::vector<Owner> owners_;       // by block
  std::vector<double> velocities_;  // of the bodies without joints, then of the mechanisms' rows
  std::vector<double> unpushed_;    // likewise, without the contacts' impulses
  std::vector<FreeBody> bodies_;
  std::vector<double> responses_;              // W of one mechanism after the other
  std::vector<MechanismRows> of_mechanism_;    // in the island's order
  std::vector<std::size_t> place_;             // by mechanism of the island: its place in that order
  std::vector<std::size_t> slot_;              // by body without joints: its offset in the velocities
  std::vector<std::size_t> slotted_;           // numbers of those that have one
  std::vector<std::array<double, 3>> before_;  // by block: impulses before solve()
  // For a hit, by block: the velocities before it, and the share of Newton's bounce that is asked for, with
  // the interval in which the right share is known to lie.
  std::vector<std::array<double, 3>> met_;
  struct Share {
    double now = 1.0, least = 0.0, most = 1.0;
  };
  std::vector<Share> shares_;
  std::size_t island_ = 0;
  Course* course_ = nullptr;
  bool apart_ = false;    // takes mechanisms apart, for a limited step
  bool at_once_ = false;  // small overlaps of contacts that are not new go at once
  Moment moment_ = kAhead;
  double h_ = 0.0;
};

}  // namespace visum::dynamics::impulse

// The rows of one moment of a step: which contacts, stops, laws and springs bind, what is asked of each, and
// how what they find comes back to bodies and mechanisms.
#pragma once

#include "server/dynamics/impulse/plant.h"
#include "server/dynamics/impulse/rows.h"

namespace visum::dynamics::impulse {

// Overlap that is left alone, m: a contact at rest stays one from tick to tick.
inline constexpr double kSurfaceLayerM = 5e-7;

inline constexpr double kMostPush = 0.5;  // m/s: what starts inside another thing is not shot out of it

class Bounded {
 public:
  explicit Bounded(Plant& plant);

  // The rows that may bind at this moment, starting from what the last step found. Mechanisms are factored.
  void build(Moment moment, double h);
  bool empty() const { return rows_.blocks.empty(); }
  std::span<const std::size_t> free_bodies() const { return slotted_; }  // that have rows
  bool binds(std::size_t mechanism) const { return !of_mechanism_[mechanism].rows.empty(); }

  // Solves with the bodies' velocities as they are, and changes them. Returns by how much they were not as
  // the rows ask.
  double solve();
  // Takes back all that solve() has done, its bodies' velocities being `v` and `w` again; from now on, and at
  // the end of the step, it only comes near an answer.
  void start_gently(std::span<const Vector3d> v, std::span<const Vector3d> w);
  // Impulses of the rows into the touches, axes and springs they are of.
  void report();
  // A collision, after build(kHit): by Newton's law of restitution, or by Poisson's.
  void bounce();

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  enum class Of { kTouch, kTwist, kLaw, kDamping, kStop, kSpring };
  struct Owner {
    Of of;
    std::size_t index = 0, side = 0;
  };
  struct MechanismRow {
    const Axis* axis = nullptr;  // of the tree; else a line
    PathMotion line;
    // An axis' response to itself, were there no loops; of one that closes a loop, no joints. 0: not known.
    double without_loops = 0.0;
  };
  struct MechanismRows {
    std::vector<MechanismRow> rows;
    std::size_t offset = 0, response = 0;
  };

  void reset(Moment moment, double h);
  void add_touch(std::size_t index);
  void add_twist(std::size_t index);
  void add_axis(std::size_t index);
  void add_law(std::size_t index);
  void add_stop(std::size_t index, std::size_t side);
  void add_spring(std::size_t index);
  RowBlock& add_block(Owner owner, std::size_t dim);
  void connect_axis(RowBlock& block, const Axis& axis);
  template <typename FindA, typename FindB>
  void connect_bodies(RowBlock& block, int a, int b, FindA find_a, FindB find_b);
  RowEnd& add_free_end(RowBlock& block, std::size_t body);
  void respond(RowBlock& block, RowEnd& end, int body) const;
  void connect_mechanism(RowBlock& block, int a, const Reach* at_a, int b, const Reach* at_b);
  RowEnd& add_mechanism_end(RowBlock& block, int mechanism);
  void finish();
  void connect_responses();
  void find_response(std::size_t mechanism);
  double rate_in_answer(std::size_t mechanism, const MechanismRow& row) const;

  void aim();
  void aim_touch(RowBlock& block, const Touch& touch, double bounce) const;
  void aim_twist(RowBlock& block, const Touch& touch) const;
  void aim_law(RowBlock& block, const Axis& axis) const;
  void aim_damping(RowBlock& block, const Axis& axis) const;
  void aim_stop(RowBlock& block, const Axis& axis, std::size_t side) const;
  void aim_spring(RowBlock& block, const Spring& spring) const;
  double solve_rows();
  void restore_by_poisson();
  void keep_energy();
  double work(std::size_t block) const;
  double rest() const;  // Rows::solve()
  void load_velocities();
  void store_velocities();
  double velocity(std::size_t mechanism, const MechanismRow& row) const;

  Plant& plant_;
  Rows rows_;
  std::vector<Owner> owners_;  // by block
  std::vector<MechanismRows> of_mechanism_;
  std::vector<std::size_t> slot_;  // by body that stands free: its offset in the velocities
  std::vector<std::size_t> slotted_;
  std::vector<std::array<double, 3>> before_;  // by block: lambda before solve()
  // Of a hit, by block: velocities before it, and the share of Newton's bounce that is asked for, with what
  // it is known to lie between.
  std::vector<std::array<double, 3>> met_;
  struct Share {
    double now = 1.0, least = 0.0, most = 1.0;
  };
  std::vector<Share> shares_;
  bool gently_ = false;  // solves by a few sweeps
  bool rests_ = false;   // the look-ahead had nothing to solve
  Moment moment_ = kAhead;
  double h_ = 0.0;
};

}  // namespace visum::dynamics::impulse

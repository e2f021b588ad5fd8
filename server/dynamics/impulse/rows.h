// Solves rows (row_block.h) with their bounds, by islands.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "server/dynamics/impulse/body_factor.h"
#include "server/dynamics/impulse/contact_lanes.h"
#include "server/dynamics/impulse/envelope_lu.h"
#include "server/dynamics/impulse/friction_cone.h"
#include "server/dynamics/impulse/lanes/kernels.h"
#include "server/dynamics/impulse/row_block.h"
#include "server/dynamics/impulse/small_system.h"
#include "server/dynamics/impulse/work_budget.h"

namespace visum::dynamics::impulse {

// The rows that one solution has to satisfy together, and all that they act on: parts of the caller's arrays.
// Indices in the blocks (offset, response, contact) count from the beginnings of these parts.
struct RowIsland {
  std::span<RowBlock> blocks;
  std::span<double> velocities;
  std::span<const FreeBody> bodies;   // the free ones, in the order of their velocities
  std::span<const double> responses;  // W of each mechanism that has rows, one after the other
  bool calm = false;                  // nothing is driven apart, so that the start is near the answer
  bool movable = false;               // every row can be moved; prepare() finds that
  double largest_change = 0.0;        // of a velocity by an impulse, since prepare(), m/s or rad/s
  bool rests = false;                 // the last solve() had nothing to do
  // An island that misses no more than a solution may, and moves by no more than this (m/s, rad/s; 0: none),
  // is frozen by solve(): each body gets the velocity `still` of one that stands, angular before linear.
  double freezes_below = 0.0;
  std::array<double, 6> still{};
  bool frozen = false;
  bool solved = false;  // the last solve() left no more than allowed, where it looked last
  // Free bodies that move take an inexact answer where an exact one is dear: after so much work since
  // prepare(), and one that is the nearer, the less work was taken before (rows_soft.cc).
  bool moves = false;
  std::uint64_t dear = UINT64_MAX;
  bool inexact = false;           // the last solve() took one
  bool changed = false;           // the last solve() has changed the velocities
  std::uint64_t sweep_units = 0;  // work of one sweep, since prepare()
};

// Solves an island of rows with bounds. Order of calls: fill an island, prepare(), then solve() any number of
// times. Owned by Bounded, used on its thread. Allocates only while it grows. Where no answer exists, the
// result may be NaN or infinite; the caller looks at that.
class Rows {
 public:
  // `work` may be null: then nothing is counted. Otherwise solve() and sweep_gently() may throw WorkSpent.
  explicit Rows(const Kernels& by = kernels(), WorkBudget* work = nullptr)
      : kernels_(&by), work_(work), factor_(by), small_(by), body_factor_(by), contact_lanes_(by) {}
  // Computes MJ of an end on a free body from its J, and adds the end's share to the block's K.
  // respond_at_point() also computes J, for three rows along the columns of a frame (sign +1) or against them
  // (-1), at a lever from the centre of mass.
  void respond(RowBlock& block, RowEnd& end, const double* inverse_inertia, double inverse_mass) const {
    kernels_->respond_to_rows(end.J[0].data(), block.dim, inverse_inertia, inverse_mass, end.MJ[0].data(),
                              block.K.data());
  }
  void respond_at_point(RowBlock& block, RowEnd& end, const double* frame, const double* lever, double sign,
                        const double* inverse_inertia, double inverse_mass) const {
    kernels_->respond_at_point(frame, lever, sign, inverse_inertia, inverse_mass, end.J[0].data(),
                               end.MJ[0].data(), block.K.data());
  }

  // Completes the blocks' K and softness, once all ends are known. What follows concerns this island, which
  // must stay valid; nothing is kept of the one before.
  void prepare(RowIsland& island);
  // Finds the impulses; velocities and `applied` follow. Stops when no row misses more than `least` (m/s or
  // rad/s), or more than `share` of the island's largest change; free bodies that are jammed, or that move
  // after much work, may miss ten times that (rows_soft.cc), and what comes near an answer may be taken if an
  // exact one is dear (RowIsland). Returns the largest miss at the start, or of the first sweep. Does nothing
  // if the start misses no more than the share `rest` of the miss that is allowed at rest; 0: always solves.
  // An island that stands still freezes (RowIsland).
  double solve(int most_sweeps, double least, double share, double rest);
  // Softens every row from now on by a share of the response that its bodies would have without joints.
  void soften(double share);
  // The blocks' `give` has changed.
  void note_gives() { hold_softly(least_softness()); }
  // True if free bodies move by no more than `limit`, m/s or rad/s, from how they stand (RowIsland::still);
  // not if that is 0.
  bool is_still(double limit) const;
  // Finds the impulses more exactly, if that is soon done: none then misses more than `least`.
  void polish(double least);
  // A few sweeps only. Impulses that push against each other stay small, even if the rows are far from their
  // targets.
  double sweep_gently(int sweeps);
  // By how much a block's rows miss what they ask for, m/s or rad/s. A NaN counts as 0.
  double miss(const RowBlock& block) const { return miss(block, errors(block)); }
  double velocity(const RowBlock& block,
                  std::size_t row) const;  // relative velocity along the row, m/s or rad/s

 private:
  // A row of the system that is solved at once. The normal of a sliding contact carries its friction along
  // (`drag`, by tangent).
  struct Row {
    std::size_t block, row;
    std::array<double, 2> drag{};
    // A row across the sliding (kAcross) has a direction, by tangent, and gives way.
    std::array<double, 2> across{};
    double compliance = 0.0;
    bool drags() const { return drag[0] != 0.0 || drag[1] != 0.0; }
    bool operator==(const Row&) const = default;
  };
  static constexpr std::size_t kAcross = 3;
  static constexpr int kMostSteps = 8;            // of solve_active()
  static constexpr std::size_t kPerResponse = 4;  // units to find one entry of the matrix
  static constexpr int kMostNewtonPasses = 8;
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  // The active rows begin..end-1 of one block. `drags`: a normal of them drags friction along.
  struct Group {
    std::size_t begin, end;
    const RowBlock* block;
    bool drags;
  };

  // The share of a step that a block can take before it meets a bound: of its first row, and of its tangents
  // (or rolling).
  struct Shares {
    double first = 1.0, tangents = 1.0;
  };

  // One projected Gauss-Seidel sweep over all blocks. Returns the largest miss that it found.
  double sweep(bool forwards);
  // Sweeps to and fro until nothing misses more than `enough`. Returns the largest miss.
  double sweep_often(int sweeps, double enough);
  // Sweeps with nonlinear conjugate gradients, until nothing misses more than `enough`. Returns the largest
  // miss.
  double sweep_and_accelerate(int most_sweeps, double enough);
  // Sets the softness of the proximal points, as a share of the rows' responses; and its least value.
  void hold_softly(double share);
  double least_softness() const;
  double left_by_softness() const;
  // From proximal point to proximal point, until the softness leaves no error. Returns false where one was
  // not found, or where they are used up.
  bool follow_points(double enough);
  // rows_soft.cc: the same from soft points on, without rolling friction. The rows miss by `missed` at the
  // start, and may miss as solve() says at the end. Notes whether an inexact answer is taken.
  bool follow_soft_points(double missed, double least, double share);
  int most_soft_passes() const;  // of Newton's method, for one point
  // The last of them. Points may miss `enough` and, where impulses creep, `allowed`.
  bool follow_firm_points(double enough, double allowed);
  bool has(RowBlock::Kind kind) const;
  // Alternates sweeps with solutions at once for one proximal point. Returns the largest miss.
  double settle(double enough);
  // The miss of a row's equation, m/s or rad/s.
  double error(const RowBlock& block, std::size_t row) const;
  // The same for all rows of a block.
  std::array<double, 3> errors(const RowBlock& block) const;
  double miss(const RowBlock& block, const std::array<double, 3>& errors) const;
  // Corrects one block. Returns the largest miss that it found.
  double relax(RowBlock& block);
  // Where rows that miss by `error` belong. The first row's impulse: at its equation or exactly at its bound;
  // the same of a row that nothing can move. The tangents' change of impulse, within the friction disc.
  double next_normal(const RowBlock& block, double error) const;
  double next_of_rigid(const RowBlock& block, double error) const;
  Tangential tangents_step(const RowBlock& block, double e1, double e2) const;
  // rows_rest.cc: true if next to nothing is missing with the impulses at the start, so that they are the
  // answer. Freezes the island if it stands still.
  bool rest_at_start(double least, double share, double rest);
  // Largest miss of any block, without correcting it. Calls find_errors(), which fills errors_.
  double largest_miss();
  void find_errors();
  // Lays the contacts of an island without mechanisms side by side. That pays where many passes follow.
  void lay_out_contacts();
  // The largest change of velocity that any impulse makes to its own row. note_change() notes it, and returns
  // the island's largest so far.
  double largest_change() const;
  double note_change();
  // Normal impulse so far, N·s; of a twist that of its contact.
  double pressure(const RowBlock& block) const;
  // Adds impulses to the velocities.
  void push(const RowBlock& block, const std::array<double, 3>& by);
  // Adds impulses to the velocities, to lambda and to applied.
  void change(RowBlock& block, const std::array<double, 3>& by);
  // The same for a block's first row, which stands at `to` then without a rounding: whether a row is at its
  // bound is asked exactly.
  void move_normal(RowBlock& block, double to);
  // Puts the starting impulses into the velocities, and the proximal points there. Returns whether any
  // velocity has changed.
  bool start();
  // Moves the proximal points to the present impulses. `beyond`: how much softer the rows are than at least,
  // as a share of their responses.
  void move_centres(double beyond);

  // rows_near.cc: with mechanisms, looks for an answer near the start, which misses by `missed`. Returns
  // false, at the start again, where there is none.
  bool settle_near_start(double missed, double enough);
  // Calls `settle`, which returns the largest miss, for one proximal point after the other.
  bool follow_near_points(double enough, const auto& settle);
  // True if much slides.
  bool slides() const;
  // True if a contact's friction is at its bound, or above it.
  static bool is_on_cone(const RowBlock& block);

  // rows_active.cc: solves all rows within their bounds at once, in at most so many steps from bound to
  // bound. Returns false if there are too many of them.
  bool solve_active(double enough, int most_steps = kMostSteps);
  // Velocities of one block's rows for unit impulses on those of another one that it meets. They stand in a
  // mechanism's W, or in pairs_, since they stay the same while the active rows change; or in `memory`, where
  // there are too many blocks.
  struct Responses {
    const double* first;
    std::size_t stride;
    double operator()(std::size_t r, std::size_t s) const { return first[r * stride + s]; }
  };
  Responses find_responses(const RowBlock& a, const RowBlock& b, double* found) const;  // room for nine
  Responses look_up_responses(const RowBlock& a, const RowBlock& b, std::array<double, 9>& memory);
  static bool stand_in_W(const RowBlock& a, const RowBlock& b);
  void start_pairs();  // makes room for pairs_, unless that has been done since prepare()
  // The same for active rows, without the friction that b drags along.
  static double response(const Responses& of, const Row& a, std::size_t s);
  static double response(const Responses& of, const Row& a, const Row& b);
  // Velocity of row r of an end for a unit impulse on row s of another end on the same body or mechanism. The
  // second adds all of them.
  double response(const RowEnd& a, std::size_t r, const RowEnd& b, std::size_t s) const;
  void add_responses(const RowBlock& a, const RowEnd& end_a, const RowBlock& b, const RowEnd& end_b,
                     double* to) const;
  // Velocity of row a for the friction that row b drags along.
  static double dragged(const Responses& of, const Row& a, const Row& b);
  // Puts a contact's, and a twist's, rows into the active list.
  void add_contact(std::size_t index);
  void add_twist(std::size_t index);
  // Lists the active rows: those within their bounds.
  void find_active();
  // Factors their system, by bodies or by rows, unless the last factor is the same. Returns false where it is
  // too large or has no positive pivot.
  bool factor_active();
  // True if the factor that is kept is that of the active rows.
  bool is_factored() const;
  // The first active rows that the kept factor has, too.
  std::size_t factored_rows() const;
  bool factor_rows(std::size_t kept);
  void add_responses(const Group& at, const Group& by, std::size_t from);
  void find_groups();
  // rows_small.cc: finds the responses of all rows, unless that has been done since prepare(). Returns false
  // if there are too many of them for small_.
  bool prepare_small();
  bool is_one_mechanism() const;
  bool factor_small();
  // Solves the factored system: from the misses in missing_ to the changes of impulse.
  void solve_factored();
  // Fills missing_ with the active rows' misses. Returns the largest.
  double find_missing(bool errors_known = false);
  // The nearest impulses that a block's bounds allow, given the pressure on a twist.
  static std::array<double, 3> within_bounds(const RowBlock& block, const std::array<double, 3>& lambda,
                                             double pressure);
  Shares shares_within_bounds(const RowBlock& block, const std::array<double, 3>& step) const;
  bool step_active();

  // rows_newton.cc: Newton's method for all rows with their bounds. Returns the largest miss; above `enough`
  // it found no answer, and came as near as that.
  struct Search {
    double enough;
    int most_passes;
    bool exact = true;  // takes one step more once it is near enough
    // The start is near the answer: what slides there still slides in the first step, for which the kept
    // factor will do.
    bool near = false;
    double loose = 1.0;        // a step that leaves no more than so many times `enough` is the last
    double hopeless = kNever;  // ends after a few passes where each has left more than this
  };
  double newton(const Search& by);
  // One step, from where largest_miss() has looked last. Returns false where the system has no factor.
  // `keep_factor`: the kept one will do if it is of the same rows, even if sliding has turned since.
  bool newton_step(bool keep_sliding, bool keep_factor);
  bool has_factor_of_same_rows() const;
  // Put a block on the side where the projection leads, and its other rows into the active list.
  void project_contact(std::size_t index, bool keep_sliding);
  void project_bounded(std::size_t index);
  // Changes a block's impulses by a projection.
  void project(RowBlock& block, const std::array<double, 3>& by);
  void project_normal(RowBlock& block, double to);
  // Puts a contact's friction onto its cone, along a direction of length 1.
  void slide_along(RowBlock& block, const Tangential& d);
  // Impulses and velocities to come back to.
  struct Point {
    std::vector<double> lambda, velocities;
  };
  void keep(Point& point) const;
  void put_back(const Point& point);

  // rows_bodies.cc: the same system with the bodies' velocities as unknowns.
  double softness(const Row& row) const;
  // True if all active rows are on free bodies only, and soft.
  bool bodies_alone() const;
  // Finds what a row measures at an end, and how it pushes there: six numbers each.
  static void direct(const Row& row, const RowEnd& end, double* measured, double* pushed);
  // The active rows from `i` on that belong to one block.
  std::span<const Row> rows_of_block(std::size_t i) const;
  void find_body_rows();  // the active rows, as the bodies' system takes them
  void connect_bodies();  // tells body_factor_ which bodies meet, unless that has been done since prepare()
  bool factor_bodies(std::size_t most_entries);

  // Counts work before it is done.
  void count_work(std::uint64_t units) const {
    if (work_ != nullptr) work_->take(units);
  }
  std::uint64_t work_taken() const { return work_ != nullptr ? work_->taken() : 0; }

  const Kernels* kernels_;
  RowIsland* island_ = nullptr;  // that was prepared
  // Its arrays.
  std::span<RowBlock> blocks_;
  std::span<double> velocities_;
  std::span<const FreeBody> bodies_;
  std::span<const double> responses_;
  WorkBudget* work_;
  std::uint64_t begun_ = 0;  // work_taken() in prepare()
  std::vector<Row> active_;
  std::vector<double> active_softness_;  // since factor_active()
  std::vector<Group> groups_;
  EnvelopeLu factor_;
  SmallSystem small_;
  std::vector<std::size_t> places_;  // of each block's first row in small_; empty: too many rows for it
  BodyFactor body_factor_;
  std::vector<BodyRow> body_rows_;  // the factored rows, for the bodies' system
  enum class System { kRows, kSmall, kBodies };
  System system_ = System::kRows;  // the one that is factored
  std::vector<double> pairs_;      // nine for each two blocks
  std::vector<char> pairs_known_;  // for each two blocks; empty: they are not kept
  // Kept since prepare(): responses of blocks to each other, or in small_, contacts side by side, the bodies'
  // order, and a factor, of which rows, with their softness.
  bool has_pairs_ = false, has_places_ = false, has_lanes_ = false, has_order_ = false, has_factor_ = false;
  bool has_settings_ = false;  // contact_lanes_ has the rows' present targets, bounds and softness
  bool projected_ = false;     // the last projection has changed an impulse
  std::vector<Row> factored_;
  std::vector<double> factored_softness_;
  // Misses of the active rows, then their changes of impulse.
  std::vector<double> missing_;
  std::vector<std::array<double, 3>> steps_;  // by block: change of impulse
  std::vector<Shares> shares_;                // by block: how much of steps_ fits
  ContactLanes contact_lanes_;
  // By block: what the rows miss, where largest_miss() or find_missing() has looked last.
  std::vector<std::array<double, 3>> errors_;
  Point start_, last_, direction_;
};

inline double Rows::velocity(const RowBlock& block, std::size_t row) const {
  double sum = 0.0;
  for (std::size_t e = 0; e < block.end_count; ++e) {
    const RowEnd& end = block.ends[e];
    sum += end.free ? dot(end.J[row], &velocities_[end.offset]) : velocities_[end.offset + end.first + row];
  }
  return sum;
}

}  // namespace visum::dynamics::impulse

// Impulses that know bounds: contacts, stops, drives at their limit, springs. A row (three for a contact)
// asks
//     u + k lambda >= or = target,  lambda within its bounds
// with u a relative velocity. Velocities are kept flat: six for each free body that a row touches (angular,
// linear), and for each mechanism that one touches, one for each row on it, with the mechanism's response W.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "server/dynamics/impulse/body_factor.h"
#include "server/dynamics/impulse/envelope_lu.h"
#include "server/dynamics/impulse/friction_cone.h"
#include "server/dynamics/impulse/lanes/kernels.h"

namespace visum::dynamics::impulse {

// Share of a free response below which a row has none: what joints hold fast cannot be moved, and no impulse
// of a contact or a stop is defined there.
inline constexpr double kRigid = 1e-9;

// What a block's rows reach on a free body: directions there, angular and linear.
using Reach = std::array<std::array<double, 6>, 3>;

// One end of a row's block. `sign`s are in J.
struct RowEnd {
  RowEnd() {}  // J and MJ are not set: most of what a block weighs

  std::size_t offset = 0;  // of the body's or mechanism's velocities
  bool free = true;
  Reach J, MJ;                      // free body: directions, and what an impulse along them does
  std::size_t mechanism = 0;        // mechanism: its number
  std::size_t first = 0, size = 0;  // mechanism: the first of its rows, and how many it has
  std::size_t response = 0;         // of W in Rows::responses
};

// Of a direction and a free body's velocities.
inline double dot(const std::array<double, 6>& a, const double* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5];
}

struct RowBlock {
  RowBlock() {}  // likewise

  enum class Kind { kContact, kTwist, kBounded };
  Kind kind = Kind::kBounded;
  std::size_t dim = 1;  // contact, twist: 3, about or along the normal first
  std::array<RowEnd, 2> ends;
  std::size_t end_count = 0;

  std::array<double, 3> target{};
  double compliance = 0.0;          // bounded
  double low = 0.0, high = 0.0;     // bounded: of lambda; contact: low, of the normal
  double friction = 0.0;            // contact; twist: of rolling, m
  double torsion = 0.0;             // twist, m
  std::size_t contact = 0;          // twist: the block whose normal presses, an earlier one
  std::array<double, 3> base{};     // contact, twist: impulses of before, which count for the bounds
  std::array<double, 3> lambda{};   // in: where to start, out
  std::array<double, 3> applied{};  // what of lambda the velocities hold already

  bool gives = false;  // contact: its normal yields a little (rows.cc), not at all at the impulse `rest`
  double rest = 0.0;

  // What a response is measured by. Contact, twist: of its bodies, were they not jointed; stop, law: of its
  // axis, were there no loops.
  double free_response = 0.0;

  // Response of each row to itself, and of the tangents to each other: of free bodies by Rows::respond(), of
  // mechanisms by Rows::prepare(), which makes what follows.
  std::array<double, 4> K{};
  std::array<double, 3> inverse_tangential{};  // of their part of K, softened: 11, 12, 22
  std::array<double, 3> softness{};            // of the proximal point, rows.cc
  std::array<double, 3> centre{};
  bool drags = false;     // rows_active.cc: slides, its friction follows its normal
  bool at_bound = false;  // rows_active.cc: its tangents were led to their bound, and stay there
};

class Rows {
 public:
  explicit Rows(const Kernels& by = kernels()) : kernels_(&by) {}
  void clear();  // keeps the memory
  // Of a block's end on a free body, whose J is set: MJ, and its share of the block's K. Of three rows along
  // a frame's columns, or against them, at a lever from the centre of mass: J, too.
  void respond(RowBlock& block, RowEnd& end, const double* inverse_inertia, double inverse_mass) const {
    kernels_->respond_to_rows(end.J[0].data(), block.dim, inverse_inertia, inverse_mass, end.MJ[0].data(),
                              block.K.data());
  }
  void respond_at_point(RowBlock& block, RowEnd& end, const double* frame, const double* lever, double sign,
                        const double* inverse_inertia, double inverse_mass) const {
    kernels_->respond_at_point(frame, lever, sign, inverse_inertia, inverse_mass, end.J[0].data(),
                               end.MJ[0].data(), block.K.data());
  }

  std::vector<RowBlock> blocks;
  std::vector<double> velocities;
  std::vector<FreeBody> bodies;   // the free ones, in their order in the velocities
  std::vector<double> responses;  // W of each mechanism that has rows, one after the other

  void prepare();
  // Finds the impulses, but for `least`, m/s or rad/s, or the share of the largest change since clear();
  // velocities and `applied` follow. Returns by how much the rows were not as they ask to be before.
  // If no more is missing than the share `rest` of what may be left at rest, nothing is done; 0: solves.
  double solve(int most_sweeps, double least, double share, double rest);
  // What joints all but block gives way from now on, by a share of what its bodies would, were they free.
  void soften(double share);
  // A few sweeps alone: what impulses hold against each other stays small, be it far from what is asked.
  double sweep_gently(int sweeps);
  bool rests() const { return rests_; }  // nothing was to be done in the last solve()
  double velocity(const RowBlock& block, std::size_t row) const;  // relative, along the row

 private:
  // A row that is solved for; the normal of what slides carries its friction along.
  struct Row {
    std::size_t block, row;
    std::array<double, 2> drag{};
  };

  // Of a step, up to a bound: of its first row, and of its tangents, or what rolls.
  struct Shares {
    double first = 1.0, tangents = 1.0;
  };

  double sweep(bool forwards);
  double sweep_and_accelerate(int most_sweeps, double enough);
  double settle(double enough);
  double error(const RowBlock& block, std::size_t row) const;
  double relax(RowBlock& block);
  double step_of_rigid(const RowBlock& block) const;
  double normal_step(const RowBlock& block) const;
  Tangential tangents_step(const RowBlock& block) const;
  bool is_at_rest(double least, double share, double rest);
  double largest_miss() const;
  double largest_change() const;
  // The contact's normal impulse so far; of a twist that of its contact.
  double pressure(const RowBlock& block) const;
  void push(const RowBlock& block, const std::array<double, 3>& by);
  void change(RowBlock& block, const std::array<double, 3>& by);
  void start();

  // rows_active.cc. False where there is nothing to be solved at once, or too much.
  bool solve_active(double enough);
  double response(const RowBlock& a, std::size_t r, const RowBlock& b, std::size_t s) const;
  double dragged(const Row& a, const Row& b) const;
  void add_contact(std::size_t index);
  void add_twist(std::size_t index);
  void find_active();
  bool factor_active();
  bool factor_rows();
  void solve_factored();
  double find_missing();
  static std::array<double, 3> within_bounds(const RowBlock& block, const std::array<double, 3>& lambda,
                                             double pressure);
  Shares shares_within_bounds(const RowBlock& block, const std::array<double, 3>& step) const;
  bool step_active();

  // rows_bodies.cc
  double softness(const Row& row) const;
  bool bodies_alone() const;
  BodyFactor::Vector6 push(const Row& row, const RowEnd& end) const;
  std::span<const Row> rows_of_block(std::size_t i) const;
  void add_to_bodies(std::span<const Row> rows);
  bool factor_bodies(std::size_t most_entries);
  void solve_bodies();

  const Kernels* kernels_;
  static constexpr std::size_t kNoBlock = static_cast<std::size_t>(-1);
  std::vector<Row> active_;
  EnvelopeLu factor_;
  BodyFactor body_factor_;
  std::vector<double> body_steps_;
  bool by_bodies_ = false;  // which of the two factors holds
  std::vector<double> missing_;
  std::vector<std::array<double, 3>> steps_;  // by block
  std::vector<Shares> shares_;                // of those, by block
  bool rests_ = false;
  double largest_ = 0.0;  // change that a solution began with since clear()
  std::vector<double> last_lambda_, last_velocities_, direction_lambda_, direction_velocities_;
};

inline double Rows::velocity(const RowBlock& block, std::size_t row) const {
  double sum = 0.0;
  for (std::size_t e = 0; e < block.end_count; ++e) {
    const RowEnd& end = block.ends[e];
    sum += end.free ? dot(end.J[row], &velocities[end.offset]) : velocities[end.offset + end.first + row];
  }
  return sum;
}

}  // namespace visum::dynamics::impulse

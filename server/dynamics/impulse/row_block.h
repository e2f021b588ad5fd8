// Rows are impulses with bounds: contacts, stops, drives at their limit, springs. A row asks for
//   u + k lambda >= target  or  = target,  lambda within its bounds
// Here u is a relative velocity, lambda the row's impulse and k its compliance. A contact has three rows.
// Velocities are kept in one flat list: six for each body without joints that a row touches (angular, then
// linear), and one for each row on a mechanism, whose rows answer each other by the mechanism's response W.
#pragma once

#include <array>
#include <cstddef>

namespace visum::dynamics::impulse {

// Smallest response that counts, as a share of the response without joints. Below it the joints hold the row
// fast: nothing can move it, and the impulse of a contact or a stop is not defined there.
inline constexpr double kRigid = 1e-9;

// Share of its response by which a contact's normal yields.
inline constexpr double kGive = 1e-5;

// The directions of a block's rows on one body, angular before linear.
using Reach = std::array<std::array<double, 6>, 3>;

// One end of a block of rows: a body without joints, or a mechanism. Signs are part of J.
struct RowEnd {
  RowEnd() {}  // J and MJ stay unset: they are most of a block's size

  std::size_t offset = 0;  // of the body's or the mechanism's velocities
  // true: on a body without joints; false: on a mechanism
  bool free = true;
  Reach J, MJ;                // body: directions, and the velocity that a unit impulse along each gives
  std::size_t mechanism = 0;  // mechanism: its index in the plant
  std::size_t first = 0,
              size = 0;  // mechanism: the first of the block's rows there, and the number of all rows there
  std::size_t response = 0;  // mechanism: where its W begins in the responses
};

// Velocity along a direction, from the six velocities of a free body.
inline double dot(const std::array<double, 6>& a, const double* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3] + a[4] * b[4] + a[5] * b[5];
}

// Up to three rows that share bodies and bounds. kContact: normal and two tangents. kTwist: torsional and
// rolling friction of a contact. kBounded: one row with two bounds (stop, law, damping, spring).
struct RowBlock {
  RowBlock() {}  // leaves the large arrays unset, as RowEnd does

  enum class Kind { kContact, kTwist, kBounded };
  Kind kind = Kind::kBounded;
  std::size_t dim = 1;  // number of rows; contact, twist: 3, the one along (about) the normal first
  std::array<RowEnd, 2> ends;
  std::size_t end_count = 0;

  // The relative velocity that each row asks for, m/s or rad/s.
  std::array<double, 3> target{};
  double compliance = 0.0;          // bounded: k, in (m/s)/(N·s) or (rad/s)/(N·m·s)
  double low = 0.0, high = 0.0;     // bounded: of lambda; contact: `low` is that of the normal
  double friction = 0.0;            // contact: coefficient; twist: of rolling friction, m
  double torsion = 0.0;             // twist: of torsional friction, m
  std::size_t contact = 0;          // twist: the block whose normal presses on it, an earlier one
  std::array<double, 3> base{};     // contact, twist: impulses of earlier moments, which count for the bounds
  std::array<double, 3> lambda{};   // before solve(): where to start; after it: the solution
  std::array<double, 3> applied{};  // the part of lambda that the velocities already contain

  // Contact: the share of K by which its normal yields (rows.cc), around the impulse `rest`; 0: it does not.
  double give = 0.0;
  double rest = 0.0;

  // The response that others are compared with. Contact, twist: of the bodies, as if they had no joints.
  // Stop, law: of the axis, as if there were no loops.
  double free_response = 0.0;

  // Response of each row to itself, and fourth the two tangents' response to each other. Rows::respond() adds
  // the bodies' part, Rows::prepare() the mechanisms', and prepare() also computes the members below.
  std::array<double, 4> K{};
  std::array<double, 3> inverse_tangential{};  // of the tangents' part of K, softened: entries 11, 12, 22
  double sliding_step = 0.0;                   // step size for sliding: 1 over that part's larger eigenvalue
  std::array<double, 3> softness{};            // of the proximal point, see rows.cc
  // The proximal point: the impulses that the softness pulls towards.
  std::array<double, 3> centre{};
  bool drags = false;     // rows_active.cc: it slides, and its friction follows its normal
  bool at_bound = false;  // rows_active.cc: its tangents have met their bound and stay there
};

// How much the velocity of a block's first row changes for a unit impulse.
inline double stiffness_of(const RowBlock& block) {
  return block.K[0] + block.compliance + block.softness[0];
}

// True if nothing can move the block's first row.
inline bool is_rigid(const RowBlock& block) {
  return !(stiffness_of(block) > kRigid * block.free_response);
}

// True if two ends, or two blocks, share a body or mechanism.
inline bool meet(const RowEnd& a, const RowEnd& b) {
  return a.free == b.free && a.offset == b.offset;
}
inline bool meet(const RowBlock& a, const RowBlock& b) {
  for (std::size_t i = 0; i < a.end_count; ++i)
    for (std::size_t j = 0; j < b.end_count; ++j)
      if (meet(a.ends[i], b.ends[j])) return true;
  return false;
}

}  // namespace visum::dynamics::impulse

// The answer of free bodies to rows that hold them, solved for the bodies instead of the rows. That needs six
// unknowns for each body, however many contacts it has. It also uses the mass matrix as it is, where the
// rows' response to each other would have to be computed.
//
// Symbols: M mass, j direction that a row measures, p direction that it pushes (j plus the friction that it
// drags along), s > 0 its softness, r what it misses, l its impulse. From  M dv = sum p l,  l = (r - j dv)/s:
//   (M + sum p j^T / s) dv = sum p r / s
// The matrix is kept in blocks of a body by a body, of which only those are stored that are not zero
// (elimination.h; George, Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981, chapter 5).
// Rows are not exchanged beyond a body's own six.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "server/dynamics/impulse/elimination.h"
#include "server/dynamics/impulse/lanes/kernels.h"

namespace visum::dynamics::impulse {

// A body without joints: kg, kg·m².
struct FreeBody {
  double mass = 0.0;
  std::array<double, 9> inertia{};  // about the centre of mass, in W
};

// Owned by Rows, used on its thread. Call in the order of the declarations; from place() on again for other
// rows on the same bodies. Nothing that is kept from one use to the next shows in a result.
class BodyFactor {
 public:
  explicit BodyFactor(const Kernels& by = kernels()) : kernels_(&by) {}

  // `bodies` must stay valid until the last factor().
  void start(std::span<const FreeBody> bodies);
  void connect(std::size_t a, std::size_t b);  // rows may hold both bodies
  // Puts M in place; false if there would be more entries. `symmetric`: all rows push along the directions
  // that they measure.
  bool place(bool symmetric, std::size_t most_entries);
  // In factor(), once placed: of each body's inverse, and of the products.
  std::uint64_t multiplications() const;
  void add(std::span<const BodyRow> rows);  // at most three, on the same bodies
  bool factor();                            // false where a body cannot be solved for
  // From what all rows that were added miss, in their order, to their impulses.
  void solve(std::span<const BodyRow> rows, std::span<double> missing);

 private:
  using Block = std::array<double, 36>;

  double* block(std::size_t a, std::size_t b);  // null where it follows from another one
  void solve_bodies();                          // steps_, in place

  const Kernels* kernels_;
  std::span<const FreeBody> bodies_;
  bool symmetric_ = false;
  Elimination elimination_;
  std::vector<Block> diagonal_, inverse_;  // by position
  std::vector<Block> lower_, upper_;       // by entry; upper_ holds the entry's transposed place
  std::vector<double> steps_;              // six for each body
};

}  // namespace visum::dynamics::impulse

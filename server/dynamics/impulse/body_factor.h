// What free bodies answer to rows that hold them, solved for the bodies instead of the rows: six unknowns for
// each body, however many contacts it stands on, and the mass matrix is at hand where the rows' response to
// each other would have to be made.
//
// Symbols: M mass, j direction that a row measures, p direction that it pushes (j, and the friction that it
// drags along), s > 0 its softness, r what it misses, l its impulse. From  M dv = sum p l,  l = (r - j dv)/s:
//   (M + sum p j^T / s) dv = sum p r / s
// In blocks of a body by a body, each row of blocks from the first that is not zero (George, Liu, Computer
// Solution of Large Sparse Positive Definite Systems, 1981, chapter 4), without exchanging rows.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace visum::dynamics::impulse {

struct FreeBody {
  double mass = 0.0;
  std::array<double, 9> inertia{};  // about the centre of mass, in W
};

class BodyFactor {
 public:
  using Vector6 = std::array<double, 6>;  // angular, linear

  // In this order, what is kept from one call to the next is memory only:
  // Symmetric: all rows push as they measure.
  void start(const std::vector<FreeBody>& bodies, bool symmetric);
  void connect(std::size_t a, std::size_t b);  // a row holds both
  bool place(std::size_t most_entries);        // M; false where there would be more entries
  // sum push measure^T: an impulse pushes a, b is where it measures.
  void add(std::size_t a, std::span<const Vector6> push, std::size_t b, std::span<const Vector6> measure);
  bool factor();                             // false where a pivot is not positive
  void solve(std::vector<double>& b) const;  // in place, six for each body

 private:
  using Block = std::array<double, 36>;
  Block& row(std::size_t i, std::size_t j) { return lower_[start_[i] + j - first_[i]]; }
  Block& column(std::size_t i, std::size_t j) { return upper_[start_[i] + j - first_[i]]; }
  void eliminate(std::size_t i, std::size_t j);

  const std::vector<FreeBody>* bodies_ = nullptr;
  bool symmetric_ = false;
  std::vector<std::size_t> first_, start_;  // by body
  std::vector<Block> lower_, upper_;        // upper_ transposed; of the diagonal only lower_ counts
  std::vector<Block> inverse_;              // of the diagonal's blocks
};

}  // namespace visum::dynamics::impulse

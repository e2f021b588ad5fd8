// LU factors of a square system whose pattern is symmetric. Each row is stored from its first entry that is
// not zero to the diagonal, and each column likewise; the factors fill no more than that (George, Liu,
// Computer Solution of Large Sparse Positive Definite Systems, 1981, chapter 4). Rows are not exchanged.
#pragma once

#include <cstddef>
#include <vector>

#include "server/dynamics/impulse/lanes/kernels.h"

namespace visum::dynamics::impulse {

// Order of calls: restart(), add() for each further row, place(), fill at() for these, factor(), solve().
// Owned by Rows, used on its thread.
class EnvelopeLu {
 public:
  explicit EnvelopeLu(const Kernels& by = kernels()) : kernels_(&by) {}
  // Keeps this many rows and columns of the factor before, which must exist: a factor's rows do not depend on
  // later ones.
  void restart(std::size_t kept = 0);
  // Adds the next row and column. Their first entries are in column and row `first`.
  void add(std::size_t first);
  void place();  // makes the entries of added rows, all zero
  std::size_t size() const { return first_.size(); }
  std::size_t first(std::size_t i) const { return first_[i]; }  // as given to add()
  std::size_t entries() const { return entries_; }              // below the diagonal and on it; as many above
  // Entry of row i, column j; it must be within the pattern.
  double& at(std::size_t i, std::size_t j) { return j <= i ? row(i)[j] : column(j)[i]; }

  bool factor();                             // false where a pivot is not positive
  void solve(std::vector<double>& b) const;  // in place

 private:
  const Kernels* kernels_;
  double* row(std::size_t i) { return lower_.data() + start_[i] - first_[i]; }
  double* column(std::size_t i) { return upper_.data() + start_[i] - first_[i]; }
  const double* row(std::size_t i) const { return lower_.data() + start_[i] - first_[i]; }
  const double* column(std::size_t i) const { return upper_.data() + start_[i] - first_[i]; }

  std::size_t kept_ = 0, entries_ = 0;
  std::vector<std::size_t> first_, start_;
  std::vector<double> lower_, upper_;  // lower_ contains the diagonal
  std::vector<double> inverse_diagonal_;
};

}  // namespace visum::dynamics::impulse

// A symmetric positive semi-definite system, each row stored from the first entry that is not zero: Cholesky,
// whose factor fills no more than that (George, Liu, Computer Solution of Large Sparse Positive Definite
// Systems, 1981, chapter 4). A row that the ones before it explain, up to a share of kDependent of what it
// would be were nothing jointed, is left out, and gets a solution of nothing.
#pragma once

#include <cstddef>
#include <vector>

namespace visum::dynamics::impulse {

class LoopFactor {
 public:
  void clear();  // keeps the memory
  // The next row, whose first entry is in column `first`; `scale` is its free response.
  void add(std::size_t first, double scale);
  std::size_t size() const { return first_.size(); }
  std::size_t rank() const;
  // Of the rows that are not left out, the least share of its free response that the ones before leave a row:
  // near a pose where the loops lose their grip, little. 1 where there are none.
  double least_share() const { return least_share_; }
  // Column j <= i, from the row's first on; to be filled (all of them) before factor().
  double& at(std::size_t i, std::size_t j) { return row(i)[j]; }
  void factor();
  void solve(std::vector<double>& b) const;  // the first size() of b, in place

 private:
  double* row(std::size_t i) { return lower_.data() + start_[i] - first_[i]; }
  const double* row(std::size_t i) const { return lower_.data() + start_[i] - first_[i]; }

  std::vector<std::size_t> first_, start_;
  std::vector<double> scale_, lower_;
  double least_share_ = 1.0;
  std::vector<double> inverse_diagonal_;  // of the factor; 0: left out
};

}  // namespace visum::dynamics::impulse

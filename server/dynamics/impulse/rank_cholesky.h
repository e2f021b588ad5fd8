// A symmetric positive semi-definite system solved on as many of its rows as are independent: Cholesky with
// complete pivoting (Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., section 10.3). A row
// that the others explain up to a share of kDependent of itself is left out, and gets a solution of nothing.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace visum::dynamics::impulse {

class RankCholesky {
 public:
  void resize(std::size_t n);
  std::size_t size() const { return n_; }
  std::size_t rank() const { return rank_; }
  // To be filled (all of it) before factor().
  double& at(std::size_t i, std::size_t j) { return matrix_[i * n_ + j]; }
  void factor();
  void solve(std::vector<double>& b);  // the first size() of b, in place

 private:
  void eliminate(std::size_t k);
  void swap(std::size_t i, std::size_t k);

  std::size_t n_ = 0, rank_ = 0;
  std::vector<double> matrix_;  // row by row; the factor L in its lower half
  std::vector<double> scale_;   // 1 over the diagonal as it was given
  std::vector<std::size_t> order_;
  std::vector<double> sorted_;
};

}  // namespace visum::dynamics::impulse

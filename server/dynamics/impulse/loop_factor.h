// Factors the symmetric positive semi-definite system of the loops. Its rows come in blocks, one for each
// loop, and each block is stored from the first column that is not zero in any of its rows. Cholesky's factor
// fills no more than that (George, Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981,
// chapter 4). Within a block, the next row is always the one that the rows before explain least (complete
// pivoting: Higham, Accuracy and Stability of Numerical Algorithms, 2002, section 10.3). A row is left out,
// and gets the solution 0, if less than the share kDependent of its free response remains unexplained.
#pragma once

#include <cstddef>
#include <vector>

namespace visum::dynamics::impulse {

// Order of calls: clear(), add_block() and add_row(), fill at(), factor(), solve(). A Mechanism owns it. It
// does not fail: rows that cannot be solved for are left out.
class LoopFactor {
 public:
  // Rows whose remaining share is smaller follow from the others.
  static constexpr double kDependent = 1e-10;

  void clear();  // keeps the memory
  // Begins the next block, whose rows' first entries are in column `first`, the first column of a block.
  void add_block(std::size_t first);
  // Adds the block's next row; `scale` is its free response.
  void add_row(double scale);
  std::size_t size() const { return start_.size(); }
  std::size_t rank() const;
  bool is_left_out(std::size_t i) const { return left_out_[i] != 0; }
  // The least share of its free response that a row keeps after the rows before it, among the rows that are
  // not left out. It gets small near a pose where the loops lose their grip. 1 where there are none.
  double least_share() const { return least_share_; }
  // Entry of column j <= i, from the block's first column on. All must be filled before factor().
  double& at(std::size_t i, std::size_t j) { return lower_[start_[i] + j - first_of(i)]; }
  void factor();
  void solve(std::vector<double>& b);  // solves for the first size() numbers of b, in place
  // With L L^T the factored system: replaces C, size() rows of `n` numbers, by Y = L^-1 C. Then
  // C^T (L L^T)^-1 C = Y^T Y. The rows of Y come in the factor's own order.
  void solve_lower(std::vector<double>& C, std::size_t n);

 private:
  struct Block {
    std::size_t first, begin, end;  // first column; rows begin..end-1
  };

  std::size_t first_of(std::size_t i) const { return blocks_[block_of_[i]].first; }
  double at(std::size_t i, std::size_t j) const { return lower_[start_[i] + j - first_of(i)]; }
  // Sorts a block's columns as the blocks before have sorted their rows.
  void take_order(const Block& block);
  // Eliminates the rows of earlier blocks from a block.
  void eliminate_before(const Block& block);
  // Brings the row with the largest remaining share to place i.
  void pivot(const Block& block, std::size_t i);
  // Eliminates row i from the rest of its block.
  void eliminate_with(const Block& block, std::size_t i);
  void swap_rows(const Block& block, std::size_t i, std::size_t k);

  std::vector<Block> blocks_;
  std::vector<std::size_t> block_of_, start_;
  std::vector<double> scale_, lower_;
  std::vector<std::size_t> order_;        // which row stands where
  std::vector<double> pivots_;            // what remains of each row of the present block
  std::vector<double> inverse_diagonal_;  // of the factor; 0: left out
  std::vector<char> left_out_;            // by row
  std::vector<double> sorted_, lower_solution_;
  double least_share_ = 1.0;
};

}  // namespace visum::dynamics::impulse

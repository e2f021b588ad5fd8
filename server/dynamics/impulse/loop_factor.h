// A symmetric positive semi-definite system, in blocks of rows (a loop's), each block stored from the first
// column that is not zero in any of its rows: Cholesky, whose factor fills no more than that (George, Liu,
// Computer Solution of Large Sparse Positive Definite Systems, 1981, chapter 4). Within a block the row comes
// first of which the ones before explain least (complete pivoting: Higham, Accuracy and Stability of
// Numerical Algorithms, 2002, section 10.3). A row that they explain up to a share of kDependent of what it
// would be were nothing jointed is left out, and gets a solution of nothing.
#pragma once

#include <cstddef>
#include <vector>

namespace visum::dynamics::impulse {

class LoopFactor {
 public:
  void clear();  // keeps the memory
  // The next block begins, whose rows' first entries are in column `first`, the first of a block.
  void add_block(std::size_t first);
  // The block's next row; `scale` is its free response.
  void add_row(double scale);
  std::size_t size() const { return start_.size(); }
  std::size_t rank() const;
  // Of the rows that are not left out, the least share of its free response that the ones before leave a row:
  // near a pose where the loops lose their grip, little. 1 where there are none.
  double least_share() const { return least_share_; }
  // Column j <= i, from the block's first on; to be filled (all of them) before factor().
  double& at(std::size_t i, std::size_t j) { return lower_[start_[i] + j - first_of(i)]; }
  void factor();
  void solve(std::vector<double>& b);  // the first size() of b, in place

 private:
  struct Block {
    std::size_t first, begin, end;  // column, rows
  };

  std::size_t first_of(std::size_t i) const { return blocks_[block_of_[i]].first; }
  double at(std::size_t i, std::size_t j) const { return lower_[start_[i] + j - first_of(i)]; }
  void take_order(const Block& block);
  void eliminate_before(const Block& block);
  void pivot(const Block& block, std::size_t i);
  void eliminate_with(const Block& block, std::size_t i);
  void swap_rows(const Block& block, std::size_t i, std::size_t k);

  std::vector<Block> blocks_;
  std::vector<std::size_t> block_of_, start_;
  std::vector<double> scale_, lower_;
  std::vector<std::size_t> order_;        // which row stands where
  std::vector<double> pivots_;            // what is left of each row of the block in hand
  std::vector<double> inverse_diagonal_;  // of the factor; 0: left out
  std::vector<double> sorted_;
  double least_share_ = 1.0;
};

}  // namespace visum::dynamics::impulse

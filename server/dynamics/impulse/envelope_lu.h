// A square system whose pattern is symmetric, each row stored from the first entry that is not zero to the
// diagonal, and each column likewise: the factors fill no more than that (George, Liu, Computer Solution of
// Large Sparse Positive Definite Systems, 1981, chapter 4). Without exchanging rows.
#pragma once

#include <cstddef>
#include <vector>

namespace visum::dynamics::impulse {

class EnvelopeLu {
 public:
  void clear();  // keeps the memory
  // The next row and column, whose first entries are in column and row `first`; all zero.
  void add(std::size_t first);
  std::size_t size() const { return first_.size(); }
  std::size_t entries() const { return lower_.size(); }  // below the diagonal, and as many above
  // Row i, column j, or the other way round, within the pattern.
  double& at(std::size_t i, std::size_t j) { return j <= i ? row(i)[j] : column(j)[i]; }

  bool factor();                             // false where a pivot is not positive
  void solve(std::vector<double>& b) const;  // in place

 private:
  double* row(std::size_t i) { return lower_.data() + start_[i] - first_[i]; }
  double* column(std::size_t i) { return upper_.data() + start_[i] - first_[i]; }
  const double* row(std::size_t i) const { return lower_.data() + start_[i] - first_[i]; }
  const double* column(std::size_t i) const { return upper_.data() + start_[i] - first_[i]; }

  std::vector<std::size_t> first_, start_;
  std::vector<double> lower_, upper_;  // the diagonal is in lower_
  std::vector<double> inverse_diagonal_;
};

}  // namespace visum::dynamics::impulse

#include "server/dynamics/impulse/loop_factor.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace visum::dynamics::impulse {

void LoopFactor::clear() {
  blocks_.clear();
  block_of_.clear();
  start_.clear();
  scale_.clear();
  lower_.clear();
}

void LoopFactor::add_block(std::size_t first) {
  blocks_.push_back({first, size(), size()});
}

void LoopFactor::add_row(double scale) {
  Block& block = blocks_.back();
  start_.push_back(lower_.size());
  block_of_.push_back(blocks_.size() - 1);
  scale_.push_back(scale);
  lower_.resize(lower_.size() + block.end - block.first + 1, 0.0);
  ++block.end;
}

std::size_t LoopFactor::rank() const {
  return size() -
         static_cast<std::size_t>(std::count(inverse_diagonal_.begin(), inverse_diagonal_.end(), 0.0));
}

void LoopFactor::factor() {
  order_.resize(size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  inverse_diagonal_.assign(size(), 0.0);
  pivots_.resize(size());
  sorted_.resize(size());
  least_share_ = 1.0;
  // Block by block; the first row that must be left out ends its block, since pivoting puts the best row
  // first.
  for (const Block& block : blocks_) {
    take_order(block);
    eliminate_before(block);
    for (std::size_t i = block.begin; i < block.end; ++i) {
      pivot(block, i);
      if (!(pivots_[i] > kDependent * scale_[i])) break;
      eliminate_with(block, i);
    }
  }
  left_out_.resize(size());
  for (std::size_t i = 0; i < size(); ++i) left_out_[order_[i]] = inverse_diagonal_[i] == 0.0;
}

// Puts the columns of the blocks before in the order that their rows have got.
void LoopFactor::take_order(const Block& block) {
  for (std::size_t i = block.begin; i < block.end; ++i) {
    for (std::size_t j = block.first; j < block.begin; ++j) sorted_[j] = at(i, order_[j]);
    for (std::size_t j = block.first; j < block.begin; ++j) at(i, j) = sorted_[j];
  }
}

// l_ij = (a_ij - sum l_ik l_jk) / l_jj; then subtracts these from the block itself.
void LoopFactor::eliminate_before(const Block& block) {
  for (std::size_t i = block.begin; i < block.end; ++i) {
    for (std::size_t j = block.first; j < block.begin; ++j) {
      double& entry = at(i, j);
      for (std::size_t k = std::max(block.first, first_of(j)); k < j; ++k) entry -= at(i, k) * at(j, k);
      entry *= inverse_diagonal_[j];
    }
    for (std::size_t j = block.begin; j <= i; ++j)
      for (std::size_t k = block.first; k < block.begin; ++k) at(i, j) -= at(i, k) * at(j, k);
    pivots_[i] = at(i, i);
  }
}

// Compares remaining shares by cross multiplication, without dividing.
void LoopFactor::pivot(const Block& block, std::size_t i) {
  std::size_t best = i;
  for (std::size_t k = i + 1; k < block.end; ++k)
    if (pivots_[k] * scale_[best] > pivots_[best] * scale_[k]) best = k;
  if (best != i) swap_rows(block, i, best);
}

// Needs i < k. The entries of later rows in columns beyond i change places as well.
void LoopFactor::swap_rows(const Block& block, std::size_t i, std::size_t k) {
  std::swap(order_[i], order_[k]);
  std::swap(scale_[i], scale_[k]);
  std::swap(pivots_[i], pivots_[k]);
  for (std::size_t j = block.first; j < i; ++j) std::swap(at(i, j), at(k, j));
  for (std::size_t j = i + 1; j < k; ++j) std::swap(at(j, i), at(k, j));
  for (std::size_t j = k + 1; j < block.end; ++j) std::swap(at(j, i), at(j, k));
  std::swap(at(i, i), at(k, k));
}

// One column of Cholesky: the pivot's root, the column, and the rest of the block.
void LoopFactor::eliminate_with(const Block& block, std::size_t i) {
  least_share_ = std::min(least_share_, pivots_[i] / scale_[i]);
  inverse_diagonal_[i] = 1.0 / std::sqrt(pivots_[i]);
  for (std::size_t k = i + 1; k < block.end; ++k) {
    at(k, i) *= inverse_diagonal_[i];
    pivots_[k] -= at(k, i) * at(k, i);
  }
  for (std::size_t k = i + 2; k < block.end; ++k)
    for (std::size_t j = i + 1; j < k; ++j) at(k, j) -= at(k, i) * at(j, i);
}

void LoopFactor::solve_lower(std::vector<double>& C, std::size_t n) {
  lower_solution_.resize(size() * n);
  for (std::size_t i = 0; i < size(); ++i) {
    double* row = &lower_solution_[i * n];
    std::copy_n(&C[order_[i] * n], n, row);
    for (std::size_t j = first_of(i); j < i; ++j) {
      const double l = at(i, j);
      const double* before = &lower_solution_[j * n];
      for (std::size_t k = 0; k < n; ++k) row[k] -= l * before[k];
    }
    for (std::size_t k = 0; k < n; ++k) row[k] *= inverse_diagonal_[i];
  }
  C.swap(lower_solution_);
}

// Columns that are left out have an inverse diagonal of 0, so their part of the solution is 0.
void LoopFactor::solve(std::vector<double>& b) {
  for (std::size_t i = 0; i < size(); ++i) sorted_[i] = b[order_[i]];
  for (std::size_t i = 0; i < size(); ++i) {
    for (std::size_t j = first_of(i); j < i; ++j) sorted_[i] -= at(i, j) * sorted_[j];
    sorted_[i] *= inverse_diagonal_[i];
  }
  // Back substitution, and back to the caller's order.
  for (std::size_t i = size(); i-- > 0;) {
    sorted_[i] *= inverse_diagonal_[i];
    for (std::size_t j = first_of(i); j < i; ++j) sorted_[j] -= at(i, j) * sorted_[i];
  }
  for (std::size_t i = 0; i < size(); ++i) b[order_[i]] = sorted_[i];
}

}  // namespace visum::dynamics::impulse
